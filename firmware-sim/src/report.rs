//! The table and the JSON.

use serde_json::json;

use crate::check::Measured;
use crate::data::Data;

const HEAD: [&str; 11] = [
    "workload",
    "target",
    "insns/frame min",
    "median",
    "max",
    "modelled cycles",
    "us",
    "of frame",
    "flash B",
    "RAM B",
    "stack B",
];

fn thousands(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

fn beside(measured: u64, allowed: u64) -> String {
    let mark = if measured > allowed { " OVER" } else { "" };
    format!("{} / {}{mark}", thousands(measured), thousands(allowed))
}

fn row(one: &Measured) -> [String; 11] {
    let [shortest, median, longest] = one.instructions;
    let (low, high) = (thousands(one.cycles.low.round() as u64), thousands(one.cycles.high.round() as u64));
    let range = if low == high { String::new() } else { format!(" [{low} .. {high}]") };
    [
        one.workload.clone(),
        one.target.clone(),
        thousands(shortest),
        thousands(median),
        beside(longest, one.allowed.instructions),
        format!("{}{range}", beside(one.gated_cycles.ceil() as u64, one.allowed.cycles)),
        format!("{:.0}", one.microseconds),
        format!("{:.2} %{}", one.share, if one.is_late() { " LATE" } else { "" }),
        format!("{} + pack {}", beside(one.flash, one.allowed.flash), thousands(one.pack)),
        beside(one.ram, one.allowed.ram),
        format!("{} (start-up {})", beside(one.stack, one.allowed.stack), thousands(one.stack_start_up)),
    ]
}

/// One table of everything, measured / allowed.
pub fn table(data: &Data, all: &[Measured]) -> String {
    let rows: Vec<[String; 11]> = std::iter::once(HEAD.map(str::to_owned)).chain(all.iter().map(row)).collect();
    let widths: [usize; 11] = std::array::from_fn(|column| rows.iter().map(|row| row[column].len()).max().unwrap_or(0));
    let mut text = String::new();
    for (index, row) in rows.iter().enumerate() {
        let cells = row.iter().zip(&widths).enumerate();
        let cells = cells.map(
            |(column, (cell, &width))| {
                if column < 2 { format!("{cell:width$}") } else { format!("{cell:>width$}") }
            },
        );
        text += &format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "));
        if index == 0 {
            let rule = widths.iter().enumerate().map(|(column, &width)| {
                if column < 2 { "-".repeat(width) } else { format!("{}:", "-".repeat(width.saturating_sub(1))) }
            });
            text += &format!("| {} |\n", rule.collect::<Vec<_>>().join(" | "));
        }
    }
    text += &format!(
        "\nEvery value is measured / allowed. Cycles are modelled (cycles.toml: zero wait states), the longest frame's, us and share \
         of a {:.0} Hz frame follow from them; [low .. high] where the manual leaves a range.\n",
        data.budgets.frame_hz
    );
    for one in all.iter().filter(|one| one.is_late()) {
        let cause = one.allowed.late.as_ref().and_then(|cause| data.budgets.causes.get(cause));
        let cause = cause.map_or("no cause is known", String::as_str);
        let (workload, target) = (&one.workload, &one.target);
        text += &format!("LATE: {workload} on {target} does not fit a frame ({:.0} %): {cause}\n", one.share);
    }
    for one in all.iter().filter(|one| one.instructions[0] != one.instructions[2]) {
        let spread = thousands(one.instructions[2] - one.instructions[0]);
        let cause = one.allowed.cause.as_ref().and_then(|cause| data.budgets.causes.get(cause));
        let cause = cause.map_or("no cause is known", String::as_str);
        let (workload, target) = (&one.workload, &one.target);
        text += &format!(
            "Spread of {workload} on {target}: {spread} / {} instructions: {cause}\n",
            thousands(one.allowed.spread)
        );
    }
    let mut compilers: Vec<&str> = all.iter().map(|one| one.compiler.as_str()).collect();
    compilers.sort_unstable();
    compilers.dedup();
    text += &format!("Compiled by {}.\n", compilers.join(", "));
    let proven = all.iter().filter(|one| one.same_bits.is_ok()).count();
    let ours = all.iter().filter(|one| one.peer.is_none());
    let (count, free) = (ours.clone().count(), ours.filter(|one| one.forbidden.is_empty()).count());
    text += &format!(
        "Output bits of every frame equal the host's: {proven} of {}. Free of panic, formatting and heap: {free} of {count}.\n",
        all.len(),
    );
    let mut peers: Vec<String> = all.iter().filter_map(peer).collect();
    peers.dedup();
    peers.iter().for_each(|peer| text += peer);
    text
}

/// What a peer is, and whether panics are linked with it.
fn peer(one: &Measured) -> Option<String> {
    let name = one.peer.as_ref()?;
    let panics = if one.forbidden.is_empty() { "no panic machinery" } else { "with panic machinery" };
    Some(format!("PEER: {} is {name}, {panics}\n", one.workload))
}

/// The dearest and the largest functions of each image.
pub fn hot(all: &[Measured]) -> String {
    let mut text = String::new();
    for one in all {
        text += &format!("{}, {}: modelled cycles of the longest frame\n", one.target, one.workload);
        for (name, cycles) in one.hot.iter().take(8) {
            text +=
                &format!("  {:5.1} %  {:>12}  {name}\n", 100.0 * cycles / one.gated_cycles, thousands(*cycles as u64));
        }
        text += &format!("{}, {}: flash without the pack, B\n", one.target, one.workload);
        for (name, size) in one.largest.iter().take(12) {
            text += &format!("  {:5.1} %  {:>12}  {name}\n", 100.0 * *size as f64 / one.flash as f64, thousands(*size));
        }
    }
    text
}

/// The limits as `budgets.toml` writes them: everything measured and `percent` more, stack and flash in round numbers.
pub fn limits(all: &[Measured], percent: f64) -> String {
    let mut text = String::new();
    let mut workload = "";
    for one in all {
        if one.workload != workload {
            workload = &one.workload;
            text += &format!("\n[limits.{workload}]\n");
        }
        let more = |value: f64, round: f64| ((value * (1.0 + percent / 100.0) / round).ceil() * round) as u64;
        let [shortest, _, longest] = one.instructions;
        // A spread is a property, not a size: none is allowed where none was measured.
        let spread = if longest == shortest { 0 } else { more((longest - shortest) as f64, 100.0) };
        let cause = one.allowed.cause.as_ref().map_or(String::new(), |cause| format!("cause = \"{cause}\", "));
        let late = one.allowed.late.as_ref().map_or(String::new(), |cause| format!("late = \"{cause}\", "));
        text += &format!(
            "{:8}= {{ instructions = {}, spread = {spread}, {cause}{late}cycles = {}, flash = {}, ram = {}, stack = {} }}\n",
            one.target,
            more(longest as f64, 100.0),
            more(one.gated_cycles, 100.0),
            more(one.flash as f64, 64.0),
            one.ram,
            more(one.stack.max(one.stack_start_up) as f64, 64.0),
        );
    }
    text
}

/// Everything measured, for machines.
pub fn json(data: &Data, all: &[Measured]) -> serde_json::Value {
    let results: Vec<serde_json::Value> = all
        .iter()
        .map(|one| {
            let hash = one.same_bits.as_ref().map(|hash| format!("{hash:016x}")).ok();
            json!({
                "workload": one.workload, "target": one.target, "compiler": one.compiler, "frames": one.frames,
                "instructions": { "min": one.instructions[0], "median": one.instructions[1], "max": one.instructions[2] },
                "modelled_cycles": one.cycles, "gated_cycles": one.gated_cycles, "microseconds": one.microseconds,
                "share_of_frame_percent": one.share, "flash": one.flash, "pack": one.pack, "ram": one.ram,
                "stack": one.stack, "stack_start_up": one.stack_start_up, "output_hash": hash, "allowed": one.allowed,
                "failures": one.failures,
                "hot": one.hot.iter().take(20).map(|(name, cycles)| json!({ "function": name, "cycles": cycles })).collect::<Vec<_>>(),
            })
        })
        .collect();
    json!({ "frame_hz": data.budgets.frame_hz, "results": results })
}
