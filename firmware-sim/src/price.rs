//! Instructions to modelled cycles: executed instructions by class, times the price in `cycles.toml`.

use std::collections::BTreeMap;
use std::ops::{Add, AddAssign, Mul};

use serde::{Deserialize, Serialize};

use crate::isa::{Class, Isa, Op};
use crate::profile::Instruction;

/// Modelled cycles: lowest, middle, highest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Cycles {
    /// As fast as the manual allows.
    pub low: f64,
    /// The value to expect.
    pub middle: f64,
    /// As slow as the manual allows.
    pub high: f64,
}

impl<'de> Deserialize<'de> for Cycles {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Form {
            One(f64),
            Three([f64; 3]),
        }
        Ok(match Form::deserialize(from)? {
            Form::One(all) => Self { low: all, middle: all, high: all },
            Form::Three([low, middle, high]) => Self { low, middle, high },
        })
    }
}

impl Add for Cycles {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { low: self.low + other.low, middle: self.middle + other.middle, high: self.high + other.high }
    }
}

impl AddAssign for Cycles {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul<f64> for Cycles {
    type Output = Self;
    fn mul(self, times: f64) -> Self {
        Self { low: self.low * times, middle: self.middle * times, high: self.high * times }
    }
}

/// Price of a class.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Price {
    each: Cycles,
    /// For each register of a list.
    #[serde(default)]
    word: Cycles,
    /// For each branch that was taken.
    #[serde(default)]
    taken: Cycles,
}

/// A part of the core that can be the bottleneck: a bound from below.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Pipe {
    #[serde(rename = "name")]
    _name: String,
    /// Classes that need it; all when empty.
    #[serde(default)]
    classes: Vec<Class>,
    each: f64,
    #[serde(default)]
    word: f64,
}

/// Which end of the range a budget is held against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Gate {
    /// The manual gives a table: its middle.
    Middle,
    /// Only a bracket is known: its high end.
    High,
}

/// Timing of one core.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Timing {
    /// The publication behind the numbers.
    pub source: String,
    /// Which end of the range a budget is held against.
    pub gate: Gate,
    load_behind_load: Option<f64>,
    #[serde(default)]
    float_use_stall: Cycles,
    #[serde(default)]
    load_use_stall: Cycles,
    #[serde(default)]
    pipes: Vec<Pipe>,
    price: BTreeMap<Class, Price>,
}

/// An executed instruction that cannot be priced.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum PriceError {
    /// The decoder does not know it.
    #[error("unknown instruction {bytes} at {address:#x}")]
    #[diagnostic(help("disassemble the image there and add the encoding to firmware-sim/src/isa"))]
    Unknown {
        /// Where.
        address: u64,
        /// Its bytes in memory order.
        bytes: String,
    },
    /// The core's table has no price for its class.
    #[error("no price for {class:?} (instruction {bytes} at {address:#x})")]
    #[diagnostic(help("add the class to the core's table in firmware-sim/cycles.toml, with its source"))]
    NoPrice {
        /// Where.
        address: u64,
        /// Its bytes in memory order.
        bytes: String,
        /// Its class.
        class: Class,
    },
}

impl Timing {
    /// The end of the range that budgets are held against.
    pub fn gated(&self, cycles: Cycles) -> f64 {
        match self.gate {
            Gate::Middle => cycles.middle,
            Gate::High => cycles.high,
        }
    }

    /// Cycles of a profile; `count` chooses (executed, taken) of each instruction.
    pub fn price(
        &self,
        isa: Isa,
        instructions: &BTreeMap<u64, Instruction>,
        count: impl Fn(&Instruction) -> (u64, u64),
    ) -> Result<Cycles, PriceError> {
        let mut ops = BTreeMap::new();
        for (address, instruction) in instructions {
            let bytes = || instruction.bytes.iter().map(|byte| format!("{byte:02x}")).collect();
            let op = isa
                .decode(&instruction.bytes)
                .ok_or_else(|| PriceError::Unknown { address: *address, bytes: bytes() })?;
            let price = self.price.get(&op.class).ok_or_else(|| PriceError::NoPrice {
                address: *address,
                bytes: bytes(),
                class: op.class,
            })?;
            ops.insert(*address, (op, price, instruction));
        }
        let mut sum = Cycles::default();
        let mut pipes = vec![0.0; self.pipes.len()];
        let mut previous: Option<(u64, Op)> = None;
        for (address, (op, price, instruction)) in &ops {
            let (executed, taken) = count(instruction);
            let executed = executed as f64;
            let next = ops.get(&(address + instruction.bytes.len() as u64)).map(|(next, ..)| next);
            sum += self.one(op, price, previous.filter(|(end, _)| end == address).map(|(_, op)| op), next) * executed;
            sum += price.taken * taken as f64;
            for (used, pipe) in pipes.iter_mut().zip(&self.pipes) {
                *used += executed * pipe.need(op);
            }
            previous = Some((address + instruction.bytes.len() as u64, *op));
        }
        if !pipes.is_empty() {
            sum.low = pipes.iter().copied().fold(0.0, f64::max);
        }
        Ok(sum)
    }

    /// One execution between its neighbours in memory, without the price of a taken branch.
    fn one(&self, op: &Op, price: &Price, previous: Option<Op>, next: Option<&Op>) -> Cycles {
        let mut cycles = price.each + price.word * f64::from(op.words);
        if let Some(behind) = self.load_behind_load
            && let Some(previous) = previous
            && op.class == Class::Load
            && previous.class == Class::Load
            && previous.writes & op.address == 0
        {
            cycles = Cycles { low: behind, middle: behind, high: behind };
        }
        if next.is_some_and(|next| next.reads & op.writes != 0) {
            match op.class {
                Class::Float | Class::FloatMac | Class::FloatDivide => cycles += self.float_use_stall,
                Class::Load => cycles += self.load_use_stall,
                _ => {}
            }
        }
        cycles
    }
}

impl Pipe {
    fn need(&self, op: &Op) -> f64 {
        if self.classes.is_empty() || self.classes.contains(&op.class) {
            self.each + self.word * f64::from(op.words)
        } else {
            0.0
        }
    }
}
