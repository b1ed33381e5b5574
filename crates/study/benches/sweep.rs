//! Throughput of sweeps on one core: cases a second, and that memory does not grow with their number.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "a bench that can not go on stops"
)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use kinstep_files::scenario::{FormulaRows, ScenarioText};
use kinstep_study::sweep::{Axis, Sweep, Table, run};

const SCENARIO: &str = r#"
sigma = 0.02
duration = 1.0
formula = "la6-wang-guo"
law = { h = 0.4 }
[[arm]]
name = "arm"
robot = "planar4"
base = "base"
tip = "tip"
task = "position-xy"
q0 = [0.3, 0.3, 0.3, 0.3]
path = { kind = "circle", radius = 0.1 }
"#;

fn sweep(samples: usize) -> Sweep {
    let axes = ["law.h=linspace(0.1, 0.6, 10)", "arm.arm.q0[1]=normal(0.3, 0.05)"];
    Sweep {
        scenarios: vec![("short".to_owned(), ScenarioText::parse(SCENARIO).unwrap())],
        axes: axes.iter().map(|text| Axis::parse(text).unwrap()).collect(),
        samples,
        seed: 1,
    }
}

/// Short plans one after the other on one thread: reading, planning 50 steps, and the line of the table.
fn short_plans(criterion: &mut Criterion) {
    let (sweep, rows) = (sweep(100), FormulaRows::default());
    let mut group = criterion.benchmark_group("sweep");
    group.throughput(Throughput::Elements(1));
    let mut index = 0;
    group.bench_function("short plan, one core", |bencher| {
        bencher.iter(|| {
            index = (index + 1) % 1000;
            sweep.run(index, &rows)
        });
    });
    group.finish();
}

/// Peak memory after 1,000 and after 20,000 cases, as the system counts it; printed, as it is not a time.
fn memory(_: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap();
    for samples in [100, 2_000] {
        let (sweep, rows) = (sweep(samples), FormulaRows::default());
        let out = folder.path().join(format!("{samples}.csv"));
        let mut swept = run(&sweep, &rows, (&out, Table::Csv, true), "bench", |_| true).unwrap();
        swept.write(&mut std::io::sink()).unwrap();
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let peak = status.lines().find(|line| line.starts_with("VmHWM")).unwrap_or("VmHWM: unknown here");
        eprintln!(
            "after {} cases: {}",
            swept.progress.done,
            peak.split_whitespace().collect::<Vec<_>>().join(" ")
        );
    }
}

criterion_group!(benches, short_plans, memory);
criterion_main!(benches);
