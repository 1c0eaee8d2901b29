//! A budget can fail, names what is over, and a second run measures the same.

use std::path::Path;
use std::process::{Command, Output};

const TARGET: &str = "m4f";
const WORKLOAD: &str = "translator";
/// A frame that lasts too long: f32 in software.
const LATE: [&str; 2] = ["m0plus", "mechanics"];

fn check(json: &Path, budgets: Option<&Path>) -> Output {
    check_on([TARGET, WORKLOAD], json, budgets)
}

fn check_on([target, workload]: [&str; 2], json: &Path, budgets: Option<&Path>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_kinesic-firmware-sim"));
    command.args(["check", "--target", target, "--workload", workload, "--json"]).arg(json);
    if let Some(budgets) = budgets {
        command.arg("--budgets").arg(budgets);
    }
    command.output().unwrap()
}

fn own_budgets() -> toml::Table {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("budgets.toml");
    toml::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
#[ignore = "needs QEMU and a compiler for the targets: ./ci.sh firmware runs it"]
fn one_percent_under_the_measured_value_fails_and_says_where() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (folder.path().join("1.json"), folder.path().join("2.json"));
    let passed = check(&first, None);
    assert!(passed.status.success(), "{}", String::from_utf8_lossy(&passed.stderr));
    let text = std::fs::read_to_string(&first).unwrap();
    let measured: serde_json::Value = serde_json::from_str(&text).unwrap();
    let result = &measured["results"][0];
    let keys = [
        ("cycles", "modelled cycles of the longest frame", result["gated_cycles"].as_f64().unwrap().ceil() as i64),
        ("instructions", "instructions of the longest frame", result["instructions"]["max"].as_i64().unwrap()),
        ("flash", "flash without the pack, B", result["flash"].as_i64().unwrap()),
        ("ram", "static RAM, B", result["ram"].as_i64().unwrap()),
    ];
    for (key, words, measured) in keys {
        let allowed = measured * 99 / 100;
        let mut budgets = own_budgets();
        budgets["limits"][WORKLOAD][TARGET][key] = toml::Value::Integer(allowed);
        let file = folder.path().join("budgets.toml");
        std::fs::write(&file, toml::to_string(&budgets).unwrap()).unwrap();
        let failed = check(&second, Some(&file));
        assert_eq!(failed.status.code(), Some(1), "{key}");
        let errors = String::from_utf8_lossy(&failed.stderr).into_owned();
        let sentence = format!("FAILED: {TARGET}, {WORKLOAD}: {words}: measured {measured}, allowed {allowed}");
        assert!(errors.contains(&sentence), "{sentence}\n{errors}");
    }
    // The same run again, to the digit.
    assert!(check(&second, None).status.success());
    assert_eq!(text, std::fs::read_to_string(&second).unwrap());
}

#[test]
#[ignore = "needs QEMU and a compiler for the targets: ./ci.sh firmware runs it"]
fn a_frame_that_does_not_fit_fails_unless_the_budget_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let (json, file) = (folder.path().join("1.json"), folder.path().join("budgets.toml"));
    let declared = check_on(LATE, &json, None);
    assert!(declared.status.success(), "{}", String::from_utf8_lossy(&declared.stderr));
    let table = String::from_utf8_lossy(&declared.stdout).into_owned();
    assert!(table.contains(" % LATE ") && table.contains("LATE: mechanics on m0plus does not fit"), "{table}");
    let mut budgets = own_budgets();
    let [target, workload] = LATE;
    budgets["limits"][workload][target].as_table_mut().unwrap().remove("late");
    std::fs::write(&file, toml::to_string(&budgets).unwrap()).unwrap();
    let failed = check_on(LATE, &json, Some(&file));
    assert_eq!(failed.status.code(), Some(1));
    let errors = String::from_utf8_lossy(&failed.stderr).into_owned();
    assert!(errors.contains("FAILED: m0plus, mechanics: a frame does not fit its time"), "{errors}");
}

#[test]
fn a_workload_without_a_limit_is_refused() {
    let mut budgets = own_budgets();
    budgets["limits"][WORKLOAD].as_table_mut().unwrap().remove(TARGET);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("budgets.toml");
    std::fs::write(&file, toml::to_string(&budgets).unwrap()).unwrap();
    let refused = check(&folder.path().join("none.json"), Some(&file));
    assert!(!refused.status.success());
    let errors = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(errors.contains("m4f is not in"), "{errors}");
}
