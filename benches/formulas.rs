//! Wall time of the exact decisions: `cargo bench --bench formulas`.

use criterion::{Criterion, criterion_group, criterion_main};
use kinstep::formula::{FeedbackRange, FormulaTable, Row, Strictness, read_rows};
use std::hint::black_box;

/// Reads, checks and ranges every row of the built-in table.
fn whole_table(criterion: &mut Criterion) {
    let text: String = FormulaTable::builtin()
        .iter()
        .map(|formula| formula.row().clone().check().to_toml())
        .collect::<Vec<_>>()
        .join("\n");
    let mut group = criterion.benchmark_group("formulas");
    group.sample_size(10);
    group.bench_function("check all rows and their feedback ranges", |bencher| {
        bencher.iter(|| {
            let rows = read_rows(black_box(&text), Strictness::Finished).expect("the built-in rows");
            let ends = |row: Row| row.check().analysis().feedback_range().map(FeedbackRange::value);
            rows.into_iter().filter_map(ends).sum::<f64>()
        });
    });
    group.finish();
}

/// Everything about one row of twenty steps: order, root condition, range, optimum, noise.
fn long_row(criterion: &mut Criterion) {
    let alpha: Vec<String> = (0..=20).map(|j| ["1", "-1"].get(j).map_or("0", |a| a).to_owned()).collect();
    let beta: Vec<String> =
        (0..=20).map(|j| if j == 0 { "0".to_owned() } else { format!("{}/210", 21 - j) }).collect();
    let row = Row::from_weights("twenty", &alpha.join(","), &beta.join(","), None).expect("a readable row");
    let mut group = criterion.benchmark_group("formulas");
    group.sample_size(10);
    group.bench_function("analyse a row of 20 steps", |bencher| {
        bencher.iter(|| {
            let checked = black_box(&row).clone().check();
            let optimum = checked.analysis().optimum().expect("a stable loop");
            (optimum, checked.analysis().noise_gain(optimum.h))
        });
    });
    group.finish();
}

/// The best feedback step of the paper's row as a surd.
fn closed_form(criterion: &mut Criterion) {
    let formula = FormulaTable::builtin().get("la6-wang-guo").expect("a built-in row");
    criterion.bench_function("closed form of the paper's optimum", |bencher| {
        bencher.iter(|| black_box(formula).analysis().closed_form());
    });
}

criterion_group!(benches, whole_table, long_row, closed_form);
criterion_main!(benches);
