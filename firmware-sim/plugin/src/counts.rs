//! The counters and their division into frames.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicPtr, AtomicU64, Ordering};

use crate::api::Counter;
use crate::code::Code;

/// A stretch of code that QEMU runs from `start` through the instruction `last`; `next` follows it in memory.
pub struct Block {
    /// Address of the first instruction.
    pub start: u64,
    /// First address behind the block.
    pub next: u64,
    /// Its last instruction, the only one that can be a branch.
    pub last: &'static Record,
}

/// Counts of one instruction.
#[derive(Default)]
pub struct Record {
    address: u64,
    bytes: Vec<u8>,
    /// Executions, in and out of frames, counted by code that QEMU emits.
    pub executed: Counter,
    /// How often the next instruction executed was another than the one behind it.
    taken: AtomicU64,
}

impl Record {
    /// Executions and taken branches so far.
    fn now(&self) -> (u64, u64) {
        (self.executed.get(), self.taken.load(Ordering::Relaxed))
    }
}

/// What belongs to one instruction beside its running counters.
#[derive(Clone, Copy, Default)]
struct Tally {
    before: (u64, u64),
    in_frames: (u64, u64),
    in_longest: (u64, u64),
}

#[derive(Default)]
struct Frames {
    records: Vec<&'static Record>,
    by_address: HashMap<u64, &'static Record>,
    tallies: Vec<Tally>,
    total_before: u64,
    open: bool,
    lengths: Vec<u64>,
}

/// All counters of a run.
pub struct Counts {
    out: String,
    /// Address that opens a frame.
    pub begin: u64,
    /// Address that closes it.
    pub end: u64,
    /// How instructions are encoded.
    pub code: Code,
    /// Every instruction but the two marks.
    pub total: Counter,
    previous: AtomicPtr<Block>,
    frames: Mutex<Frames>,
}

impl Counts {
    /// No counts yet.
    pub fn new(out: String, begin: u64, end: u64, code: Code) -> Self {
        Self {
            out,
            begin,
            end,
            code,
            total: Counter::default(),
            previous: AtomicPtr::default(),
            frames: Mutex::default(),
        }
    }

    fn frames(&self) -> std::sync::MutexGuard<'_, Frames> {
        self.frames.lock().expect("no callback panics")
    }

    /// The counter of the instruction at `address`: the same one however often QEMU translates it.
    pub fn record(&self, address: u64, bytes: &[u8]) -> &'static Record {
        let mut frames = self.frames();
        let frames = &mut *frames;
        frames.by_address.entry(address).or_insert_with(|| {
            let record = Box::leak(Box::new(Record { address, bytes: bytes.to_vec(), ..Record::default() }));
            frames.records.push(record);
            frames.tallies.push(Tally::default());
            record
        })
    }

    /// A block starts: if it does not lie behind the previous one, that one's last instruction was a taken branch.
    /// (A branch to the very next instruction is not seen; compilers do not write one.)
    ///
    /// Called for every block, hence no lock; one core runs all blocks, hence relaxed loads and stores suffice.
    pub fn enter(&self, block: &'static Block) {
        let previous = self.previous.swap(std::ptr::from_ref(block).cast_mut(), Ordering::Relaxed);
        // SAFETY: null or a leaked block.
        if let Some(previous) = unsafe { previous.as_ref() }
            && previous.next != block.start
        {
            let taken = &previous.last.taken;
            taken.store(taken.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
        }
    }

    /// A frame opens: remember where every counter stands.
    pub fn begin(&self) {
        let mut frames = self.frames();
        let frames = &mut *frames;
        for (record, tally) in frames.records.iter().zip(&mut frames.tallies) {
            tally.before = record.now();
        }
        frames.total_before = self.total.get();
        frames.open = true;
    }

    /// A frame closes: book the differences.
    pub fn end(&self) {
        let mut frames = self.frames();
        let frames = &mut *frames;
        if !std::mem::take(&mut frames.open) {
            return;
        }
        let length = self.total.get() - frames.total_before;
        let longest = frames.lengths.iter().all(|&other| length > other);
        frames.lengths.push(length);
        for (record, tally) in frames.records.iter().zip(&mut frames.tallies) {
            let now = record.now();
            let (executed, taken) = (now.0 - tally.before.0, now.1 - tally.before.1);
            tally.in_frames.0 += executed;
            tally.in_frames.1 += taken;
            if longest {
                tally.in_longest = (executed, taken);
            }
        }
    }

    /// Writes the file that the crate's documentation describes.
    pub fn write(&self) -> io::Result<()> {
        let frames = self.frames();
        let mut out = BufWriter::new(File::create(&self.out)?);
        writeln!(out, "frames {}", frames.lengths.len())?;
        let lengths: Vec<String> = frames.lengths.iter().map(u64::to_string).collect();
        writeln!(out, "{}", lengths.join(" "))?;
        writeln!(out, "instructions {}", frames.tallies.iter().filter(|tally| tally.in_frames.0 > 0).count())?;
        for (record, tally) in frames.records.iter().zip(&frames.tallies).filter(|(_, tally)| tally.in_frames.0 > 0) {
            write!(out, "{:x} ", record.address)?;
            record.bytes.iter().try_for_each(|byte| write!(out, "{byte:02x}"))?;
            let ((executed, taken), (longest, longest_taken)) = (tally.in_frames, tally.in_longest);
            writeln!(out, " {executed} {taken} {longest} {longest_taken}")?;
        }
        out.flush()
    }
}
