//! STM32F405 (RM0090): the four channels of TIM2 on PA0 to PA3, text from USART1 on PA9, the internal 16 MHz.

use core::fmt;

use super::registers::{change, read, start_systick, until, write};
use super::robot::{RATE, SERVOS};

/// The clock after reset. It is fast enough: nothing is set up.
const CLOCK: u32 = 16_000_000;
const BAUD: u32 = 115_200;

const RCC_AHB1ENR: u32 = 0x4002_3830;
const RCC_APB1ENR: u32 = 0x4002_3840;
const RCC_APB2ENR: u32 = 0x4002_3844;
const GPIOA_MODER: u32 = 0x4002_0000;
const GPIOA_AFRL: u32 = 0x4002_0020;
const GPIOA_AFRH: u32 = 0x4002_0024;
const TIM2: u32 = 0x4000_0000;
const TIM2_CR1: u32 = TIM2;
const TIM2_EGR: u32 = TIM2 + 0x14;
const TIM2_CCMR1: u32 = TIM2 + 0x18;
const TIM2_CCMR2: u32 = TIM2 + 0x1c;
const TIM2_CCER: u32 = TIM2 + 0x20;
const TIM2_PSC: u32 = TIM2 + 0x28;
const TIM2_ARR: u32 = TIM2 + 0x2c;
/// Compare registers of the four channels.
const TIM2_CCR: [u32; SERVOS] = [TIM2 + 0x34, TIM2 + 0x38, TIM2 + 0x3c, TIM2 + 0x40];
const USART1_SR: u32 = 0x4001_1000;
const USART1_DR: u32 = 0x4001_1004;
const USART1_BRR: u32 = 0x4001_1008;
const USART1_CR1: u32 = 0x4001_100c;

/// Clocks of the port, the timer and the serial port; pins to what drives them.
pub fn start_clocks() {
    change(RCC_AHB1ENR, 0, 1);
    change(RCC_APB1ENR, 0, 1);
    change(RCC_APB2ENR, 0, 1 << 4);
    // PA0 to PA3: alternate function 1, TIM2. PA9: alternate function 7, USART1.
    change(GPIOA_AFRL, 0xffff, 0x1111);
    change(GPIOA_AFRH, 0xf0, 0x70);
    change(GPIOA_MODER, 0b11 << 18 | 0xff, 0b10 << 18 | 0xaa);
}

/// Starts the pulses.
pub fn start_pulses(pulses: &[u16; SERVOS]) {
    // A tick is a microsecond.
    write(TIM2_PSC, CLOCK / 1_000_000 - 1);
    write(TIM2_ARR, 1_000_000 / RATE - 1);
    // High up to the compare value, which is taken over when a period begins.
    write(TIM2_CCMR1, 0x6868);
    write(TIM2_CCMR2, 0x6868);
    write(TIM2_CCER, 0x1111);
    set_pulses(pulses);
    write(TIM2_EGR, 1);
    write(TIM2_CR1, 0x81);
}

/// Pulse widths for the next period, microseconds.
pub fn set_pulses(pulses: &[u16; SERVOS]) {
    for (register, pulse) in TIM2_CCR.into_iter().zip(pulses) {
        write(register, u32::from(*pulse));
    }
}

/// What the compare registers hold.
pub fn pulses() -> [u16; SERVOS] {
    TIM2_CCR.map(|register| read(register) as u16)
}

/// Starts the interrupt of the frames.
pub fn start_timer() {
    start_systick(CLOCK / RATE);
}

/// Text to USART1, 115200 baud, 8N1.
pub struct Serial;

impl Serial {
    /// Starts the port.
    pub fn start() -> Self {
        write(USART1_BRR, (CLOCK + BAUD / 2) / BAUD);
        write(USART1_CR1, 1 << 13 | 1 << 3);
        Self
    }
}

impl fmt::Write for Serial {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            until(USART1_SR, 1 << 7);
            write(USART1_DR, u32::from(byte));
        }
        Ok(())
    }
}
