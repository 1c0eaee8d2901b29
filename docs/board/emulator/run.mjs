// Runs an image on an emulated RP2040, prints what its serial port says, and measures the pulses at its pins.
//
//   npm ci && node run.mjs IMAGE [FRAMES [PULSES.csv]]
//
// It ends after so many frames, 800 unless told: SysTick interrupts, which begin at power-on. PULSES.csv gets the width of every pulse
// at GPIO 2 to 5, microseconds, a line a period.

import { readFileSync, writeFileSync } from 'node:fs';
import { ConsoleLogger, GPIOPinState, LogLevel, RP2040 } from 'rp2040js';

const [image, frames = '800', pulses] = process.argv.slice(2);
if (!image) {
  console.error('usage: node run.mjs IMAGE [FRAMES [PULSES.csv]]');
  process.exit(2);
}

const chip = new RP2040();
chip.logger = new ConsoleLogger(LogLevel.Error, true);
chip.onBreak = (code) => {
  console.error(`the program stopped at a breakpoint: ${code}`);
  process.exit(1);
};

// The segments of the ELF file go to the flash, as a probe or a UF2 file would put them there.
const elf = readFileSync(image);
const word = (at) => elf.readUInt32LE(at);
const half = (at) => elf.readUInt16LE(at);
const FLASH = 0x10000000;
for (let i = 0; i < half(44); i++) {
  const at = word(28) + i * half(42);
  const [kind, offset, , address, size] = [0, 4, 8, 12, 16].map((field) => word(at + field));
  if (kind === 1 && size > 0) chip.flash.set(elf.subarray(offset, offset + size), address - FLASH);
}

// What the boot ROM does: it takes the first 256 bytes of the flash to the end of the RAM, checks their sum, and starts them.
const BOOT = 0x41f00;
const stage = chip.flash.subarray(0, 256);
let sum = -1;
for (const byte of stage.subarray(0, 252)) {
  sum ^= byte << 24;
  for (let bit = 0; bit < 8; bit++) sum = (sum << 1) ^ (sum < 0 ? 0x04c11db7 : 0);
}
if (sum >>> 0 !== chip.flashView.getUint32(252, true)) {
  console.error('the first 256 bytes of the image are no second stage: a chip would not start it');
  process.exit(1);
}
chip.sram.set(stage, BOOT);
const core = chip.core;
[core.SP, core.LR, core.PC] = [0x20000000 + BOOT, 0, 0x20000000 + BOOT];

let line = '';
chip.uart[0].onByte = (byte) => {
  line += String.fromCharCode(byte);
  if (byte === 10) {
    process.stdout.write(line);
    line = '';
  }
};

// Rising to falling edge at the pins, in the emulator's own time.
const widths = [2, 3, 4, 5].map((pin) => {
  const seen = [];
  let rise;
  chip.gpio[pin].addListener((state) => {
    if (state === GPIOPinState.High) rise = chip.clock.nanos;
    if (state === GPIOPinState.Low && rise !== undefined) seen.push((chip.clock.nanos - rise) / 1000);
  });
  return seen;
});

// A frame is an interrupt of SysTick, from its first instruction to its last.
const SYSTICK = 15;
let [begun, inside] = [0, false];
const cycles = [];
const deadline = (Number(frames) + 10) * 20e6;
for (;;) {
  if (core.waiting) {
    if (cycles.length >= Number(frames)) break;
    chip.clock.tick(chip.clock.nanosToNextAlarm);
    // SysTick ends a sleep too; rp2040js 1.4.1 wakes for the other interrupts alone.
    if (core.pendingSystick && core.checkForInterrupts()) core.waiting = false;
  }
  if (!core.waiting) chip.clock.tick((core.executeInstruction() * 1e9) / chip.clkSys);
  if (chip.clock.nanos > deadline) {
    console.error(`${cycles.length} frames in ${chip.clock.nanos / 1e9} s of the chip's time: the timer does not run at 50 frames a second`);
    process.exit(1);
  }
  const handles = core.IPSR === SYSTICK;
  if (handles && !inside) begun = core.cycles;
  if (!handles && inside) {
    cycles.push(core.cycles - begun);
  }
  inside = handles;
}
// The first frame loads the pack.
const longest = Math.max(...cycles.slice(1));
console.error(`${cycles.length} frames at ${chip.clkSys / 1e6} MHz; the first took ${cycles[0]} cycles, the longest of the others ${longest}`);
if (pulses) {
  const periods = widths[0].map((_, at) => widths.map((pin) => pin[at]?.toFixed(3) ?? '').join(','));
  writeFileSync(pulses, `pan,tilt,left_antenna,right_antenna\n${periods.join('\n')}\n`);
}
