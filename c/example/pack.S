@ The pack in flash, aligned as its typed views need it.
    .section .rodata.pack, "a"
    .balign 16
    .global pack, pack_end
pack:
    .incbin PACK
pack_end:
