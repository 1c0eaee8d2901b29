# t0-t6 and a0-a7 are scratch by the calling convention.
    .section .text.calibrate,"ax",@progbits
    .macro function name
    .balign 4
    .global \name
    .type \name, @function
\name:
    .endm

# 1 + 100 x (add, subtract, branch) + return
    function loop_adds
    li a0, 100
1:  addi a1, a1, 1
    addi a0, a0, -1
    bnez a0, 1b
    ret
    .size loop_adds, . - loop_adds

# 1 + 50 x (multiply, subtract, branch) + return
    function loop_multiplies
    li a0, 50
1:  mul a1, a1, a0
    addi a0, a0, -1
    bnez a0, 1b
    ret
    .size loop_multiplies, . - loop_multiplies

# 2 + 20 x (load, load used at once, store, subtract, branch) + restore + return
    function loop_loads
    li a0, 20
    addi sp, sp, -16
1:  lw a1, 0(sp)
    lw a2, 4(sp)
    sw a2, 8(sp)
    addi a0, a0, -1
    bnez a0, 1b
    addi sp, sp, 16
    ret
    .size loop_loads, . - loop_loads

# 3 + 10 x (call, return, subtract, branch) + 3
    function loop_calls
    addi sp, sp, -16
    sw ra, 12(sp)
    li a0, 10
1:  jal ra, calibrate_leaf
    addi a0, a0, -1
    bnez a0, 1b
    lw ra, 12(sp)
    addi sp, sp, 16
    ret
    .size loop_calls, . - loop_calls

    function calibrate_leaf
    ret
    .size calibrate_leaf, . - calibrate_leaf
    .previous
