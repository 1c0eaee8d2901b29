//! RP2040 (its datasheet), as on a Pico: PWM on GPIO 2 to 5, text from UART 0 on GPIO 0, 125 MHz from a crystal of 12 MHz.

use core::fmt;

use super::registers::{change, read, start_systick, until, write};
use super::robot::{RATE, SERVOS};

const CLOCK: u32 = 125_000_000;
const BAUD: u32 = 115_200;

const RESETS_RESET: u32 = 0x4000_c000;
const RESETS_DONE: u32 = 0x4000_c008;
/// IO_BANK0, PADS_BANK0, PLL_SYS, PWM.
const USED: u32 = 1 << 5 | 1 << 8 | 1 << 12 | 1 << 14;
const UART0: u32 = 1 << 22;
const XOSC_CTRL: u32 = 0x4002_4000;
const XOSC_STATUS: u32 = 0x4002_4004;
const XOSC_STARTUP: u32 = 0x4002_400c;
const PLL_CS: u32 = 0x4002_8000;
const PLL_PWR: u32 = 0x4002_8004;
const PLL_FBDIV: u32 = 0x4002_8008;
const PLL_PRIM: u32 = 0x4002_800c;
const CLK_REF_CTRL: u32 = 0x4000_8030;
const CLK_REF_SELECTED: u32 = 0x4000_8038;
const CLK_SYS_CTRL: u32 = 0x4000_803c;
const CLK_SYS_SELECTED: u32 = 0x4000_8044;
const CLK_PERI_CTRL: u32 = 0x4000_8048;
/// Control of pin 0; 8 bytes a pin.
const GPIO_CTRL: u32 = 0x4001_4004;
/// Slices 1 and 2: channels A and B of them are GPIO 2 to 5.
const SLICES: [u32; 2] = [0x4005_0014, 0x4005_0028];
// In a slice.
const CSR: u32 = 0;
const DIV: u32 = 4;
const CC: u32 = 12;
const TOP: u32 = 16;
const UART_DR: u32 = 0x4003_4000;
const UART_FR: u32 = 0x4003_4018;
const UART_IBRD: u32 = 0x4003_4024;
const UART_FBRD: u32 = 0x4003_4028;
const UART_LCR_H: u32 = 0x4003_402c;
const UART_CR: u32 = 0x4003_4030;

/// What the boot ROM starts: it makes the flash readable and goes on to the program.
#[unsafe(link_section = ".boot2")]
#[used]
static BOOT2: [u8; 256] = rp2040_boot2::BOOT_LOADER_W25Q080;

/// The core from the crystal's PLL; pins to what drives them.
pub fn start_clocks() {
    // The crystal: 1 ms to start, in units of 256 of its periods.
    write(XOSC_STARTUP, 47);
    write(XOSC_CTRL, 0x00fa_baa0);
    until(XOSC_STATUS, 1 << 31);
    // The core on the crystal while the PLL starts.
    write(CLK_REF_CTRL, 2);
    until(CLK_REF_SELECTED, 1 << 2);
    change(CLK_SYS_CTRL, 1, 0);
    until(CLK_SYS_SELECTED, 1);
    change(RESETS_RESET, USED, 0);
    until(RESETS_DONE, USED);
    // 12 MHz times 125, through 6 and 2.
    write(PLL_CS, 1);
    write(PLL_FBDIV, 125);
    change(PLL_PWR, 1 | 1 << 5, 0);
    until(PLL_CS, 1 << 31);
    write(PLL_PRIM, 6 << 16 | 2 << 12);
    change(PLL_PWR, 1 << 3, 0);
    write(CLK_SYS_CTRL, 0);
    write(CLK_SYS_CTRL, 1);
    until(CLK_SYS_SELECTED, 1 << 1);
    // The serial port from the core's clock: it does not leave its reset without one.
    write(CLK_PERI_CTRL, 1 << 11);
    change(RESETS_RESET, UART0, 0);
    until(RESETS_DONE, UART0);
    write(GPIO_CTRL, 2);
    for pin in 2..6 {
        write(GPIO_CTRL + 8 * pin, 4);
    }
}

/// Starts the pulses.
pub fn start_pulses(pulses: &[u16; SERVOS]) {
    set_pulses(pulses);
    for slice in SLICES {
        // A tick is a microsecond.
        write(slice + DIV, (CLOCK / 1_000_000) << 4);
        write(slice + TOP, 1_000_000 / RATE - 1);
        write(slice + CSR, 1);
    }
}

/// Pulse widths for the next period, microseconds: the slices take them over when a period begins.
pub fn set_pulses(pulses: &[u16; SERVOS]) {
    let [pan, tilt, left, right] = pulses.map(u32::from);
    for (slice, value) in SLICES.into_iter().zip([tilt << 16 | pan, right << 16 | left]) {
        write(slice + CC, value);
    }
}

/// What the compare registers hold.
pub fn pulses() -> [u16; SERVOS] {
    let [head, antennas] = SLICES.map(|slice| read(slice + CC));
    [head as u16, (head >> 16) as u16, antennas as u16, (antennas >> 16) as u16]
}

/// Starts the interrupt of the frames.
pub fn start_timer() {
    start_systick(CLOCK / RATE);
}

/// Text to UART 0, 115200 baud, 8N1.
pub struct Serial;

impl Serial {
    /// Starts the port.
    pub fn start() -> Self {
        // In 64ths: 16 samples a bit.
        let divisor = (8 * CLOCK / BAUD).div_ceil(2);
        write(UART_IBRD, divisor >> 6);
        write(UART_FBRD, divisor & 63);
        // 8 bits, with a queue; on, sending.
        write(UART_LCR_H, 3 << 5 | 1 << 4);
        write(UART_CR, 1 << 8 | 1);
        Self
    }
}

impl fmt::Write for Serial {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            // The queue is full.
            while read(UART_FR) & 1 << 5 != 0 {}
            write(UART_DR, u32::from(byte));
        }
        Ok(())
    }
}
