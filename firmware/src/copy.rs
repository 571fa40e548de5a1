//! The memory copy functions that the compiler calls, written in assembly. They copy four words at a time.
//!
//! The compiler library's own copy takes five instructions per word if it was built for size. A control law is 114 words long and
//! is copied in the control period in which the device is armed. The compiler's symbols are weak, so the linker takes these
//! functions instead.

use core::arch::global_asm;

// ARM run-time ABI: r0 is the destination, r1 the source and r2 the number of bytes. Both addresses are aligned to words. Nothing
// is returned.
global_asm!(
    ".syntax unified",
    ".section .text.__aeabi_memcpy4, \"ax\", %progbits",
    ".global __aeabi_memcpy4",
    ".global __aeabi_memcpy8",
    ".type __aeabi_memcpy4, %function",
    ".type __aeabi_memcpy8, %function",
    ".thumb_func",
    "__aeabi_memcpy8:",
    ".thumb_func",
    "__aeabi_memcpy4:",
    "push {{r4, r5, r6, lr}}",
    "2: subs r2, #16",
    "blo 3f",
    "ldmia r1!, {{r3, r4, r5, r6}}",
    "stmia r0!, {{r3, r4, r5, r6}}",
    "b 2b",
    "3: adds r2, #16",
    "4: subs r2, #4",
    "blo 5f",
    "ldr r3, [r1], #4",
    "str r3, [r0], #4",
    "b 4b",
    "5: adds r2, #4",
    "beq 7f",
    "6: ldrb r3, [r1], #1",
    "strb r3, [r0], #1",
    "subs r2, #1",
    "bne 6b",
    "7: pop {{r4, r5, r6, pc}}",
    ".size __aeabi_memcpy4, . - __aeabi_memcpy4",
    ".size __aeabi_memcpy8, . - __aeabi_memcpy8",
);
