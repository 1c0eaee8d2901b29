@ Single-precision arithmetic of the FPU; s0-s15 are scratch by the calling convention.
    .syntax unified
    .section .text.calibrate_vfp,"ax",%progbits
    .balign 4
    .global loop_floats
    .type loop_floats, %function
    .thumb_func
@ 1 + 30 x (multiply, add that waits for it, fused multiply-add, list of 4, subtract, branch) + restore + return
loop_floats:
    movs r0, #30
    sub sp, #16
1:  vmul.f32 s0, s1, s2
    vadd.f32 s3, s0, s4
    vfma.f32 s5, s6, s7
    mov r3, sp
    vldmia r3!, {s8-s11}
    subs r0, #1
    bne 1b
    add sp, #16
    bx lr
    .size loop_floats, . - loop_floats
    .previous
