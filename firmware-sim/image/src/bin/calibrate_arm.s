@ Thumb-1 encodings only, so that one source serves every Cortex-M. r0-r3 are scratch by the calling convention.
    .syntax unified
    .section .text.calibrate,"ax",%progbits
    .macro function name
    .balign 4
    .global \name
    .type \name, %function
    .thumb_func
\name:
    .endm

@ 1 + 100 x (add, subtract, branch) + return
    function loop_adds
    movs r0, #100
1:  adds r1, #1
    subs r0, #1
    bne 1b
    bx lr
    .size loop_adds, . - loop_adds

@ 1 + 50 x (multiply, subtract, branch) + return
    function loop_multiplies
    movs r0, #50
1:  muls r1, r0, r1
    subs r0, #1
    bne 1b
    bx lr
    .size loop_multiplies, . - loop_multiplies

@ 2 + 20 x (2 loads, store, list of 2, subtract, branch) + restore + return
    function loop_loads
    movs r0, #20
    sub sp, #16
1:  ldr r1, [sp, #0]
    ldr r2, [sp, #4]
    str r1, [sp, #8]
    mov r3, sp
    ldmia r3!, {r1, r2}
    subs r0, #1
    bne 1b
    add sp, #16
    bx lr
    .size loop_loads, . - loop_loads

@ push, 1 + 10 x (call, return, subtract, branch), pop to pc
    function loop_calls
    push {r4, lr}
    movs r4, #10
1:  bl calibrate_leaf
    subs r4, #1
    bne 1b
    pop {r4, pc}
    .size loop_calls, . - loop_calls

    function calibrate_leaf
    bx lr
    .size calibrate_leaf, . - calibrate_leaf
    .previous
