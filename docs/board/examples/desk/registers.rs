//! Registers by address: all unsafe blocks are here. In a project of your own a crate of the part does this.

/// Reads a register. The addresses are those of the board files.
pub fn read(address: u32) -> u32 {
    // SAFETY: the board files name registers of the part they are for: always there, aligned, and no memory of Rust's.
    unsafe { (address as *const u32).read_volatile() }
}

/// Writes a register.
pub fn write(address: u32, value: u32) {
    // SAFETY: as above. None of the registers written here lets the hardware write to memory.
    unsafe { (address as *mut u32).write_volatile(value) }
}

/// Changes the bits of `mask` to those of `value`, and reads the register back, so that the change is done when this returns.
pub fn change(address: u32, mask: u32, value: u32) {
    write(address, (read(address) & !mask) | value);
    read(address);
}

/// Waits until all bits of `mask` are set.
pub fn until(address: u32, mask: u32) {
    while read(address) & mask != mask {}
}

/// Sleeps from interrupt to interrupt while something holds.
pub fn wait_while(holds: impl Fn() -> bool) {
    loop {
        // An interrupt that comes between the question and the sleep ends the sleep, and is taken after it.
        // SAFETY: interrupts are off for no longer than the question, and nothing here needs them to be on.
        unsafe { core::arch::asm!("cpsid i") };
        let holds = holds();
        if holds {
            // SAFETY: the instruction changes nothing.
            unsafe { core::arch::asm!("wfi") };
        }
        // SAFETY: they were on.
        unsafe { core::arch::asm!("cpsie i") };
        if !holds {
            return;
        }
    }
}

/// SysTick counts the core's clock, `cycles` an interrupt, at most 2^24.
pub fn start_systick(cycles: u32) {
    const CONTROL: u32 = 0xe000_e010;
    const RELOAD: u32 = 0xe000_e014;
    const CURRENT: u32 = 0xe000_e018;
    write(RELOAD, cycles - 1);
    write(CURRENT, 0);
    // The core's clock, with an interrupt, on.
    write(CONTROL, 0b111);
}
