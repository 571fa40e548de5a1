//! Copies the interrupts' code at start-up, before other code runs, to a memory without wait states. The linker script `fast.x`
//! names that memory.

use core::arch::global_asm;

// The start-up code calls this function when only a stack exists. It is in assembly, because no variable has its initial value yet.
// It copies whole words, because the section consists of words.
global_asm!(
    ".syntax unified",
    ".section .text.__pre_init, \"ax\", %progbits",
    ".global __pre_init",
    ".type __pre_init, %function",
    ".thumb_func",
    "__pre_init:",
    "ldr r0, =_fast_start",
    "ldr r1, =_fast_end",
    "ldr r2, =_fast_kept",
    "2: cmp r0, r1",
    "bhs 3f",
    "ldmia r2!, {{r3}}",
    "stmia r0!, {{r3}}",
    "b 2b",
    // The copied words are code: the barriers make sure that no instruction is fetched before it is written (ARMv7-M, A3.5.4).
    "3: dsb",
    "isb",
    "bx lr",
    ".size __pre_init, . - __pre_init",
);
