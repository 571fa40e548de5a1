//! Copies the interrupts' code at start-up, before other code runs, to the memory without wait states that `fast.x` names.

use core::arch::global_asm;

// Called by the start-up, with a stack and nothing else: in assembly, as no variable has its value yet. Whole words, of which the section is made.
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
    // What was written is code: nothing is fetched before it is there (ARMv7-M, A3.5.4).
    "3: dsb",
    "isb",
    "bx lr",
    ".size __pre_init, . - __pre_init",
);
