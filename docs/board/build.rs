//! Tells the linker where the part has its memory, and turns the desk robot's move into a table in flash.
use std::env::var;
use std::fmt::Write;
use std::path::{Path, PathBuf};

const MOVE: &str = "examples/desk/move.csv";
const COLUMNS: &str = "time_s,pan_deg,tilt_deg,left_antenna_deg,right_antenna_deg";

fn main() {
    let layout = match &*var("TARGET").expect("cargo sets it") {
        "thumbv6m-none-eabi" => "rp2040.x",
        target if target.starts_with("riscv32") => "qemu-virt.x",
        _ => "stm32f405.x",
    };
    let out = PathBuf::from(var("OUT_DIR").expect("cargo sets it"));
    std::fs::copy(layout, out.join("memory.x")).expect("the layout beside build.rs");
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-link-arg=-Tlink.x");
    println!("cargo:rerun-if-changed={layout}");
    table(&out);
}

/// Degrees of a CSV as `MOVE`, rad.
fn table(out: &Path) {
    let text = std::fs::read_to_string(MOVE).expect(MOVE);
    let (header, rows) = text.split_once('\n').expect(MOVE);
    assert_eq!(header, COLUMNS, "{MOVE}");
    let mut table = format!("static MOVE: [[f32; SERVOS]; {}] = [\n", rows.lines().count());
    for row in rows.lines() {
        let angle = |cell: &str| cell.parse::<f64>().expect(MOVE).to_radians() as f32;
        writeln!(table, "    {:?},", row.split(',').skip(1).map(angle).collect::<Vec<_>>()).expect("memory");
    }
    std::fs::write(out.join("move.rs"), table + "];\n").expect("OUT_DIR");
    println!("cargo:rerun-if-changed={MOVE}");
}
