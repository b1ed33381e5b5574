//! Wall time of what a control loop repeats: `cargo bench --bench steps`.

mod works;

use criterion::{Criterion, criterion_group, criterion_main};

fn all(criterion: &mut Criterion) {
    for name in works::NAMES {
        let mut work = works::by_name(name).expect("every listed work has its name");
        criterion.bench_function(name, |bencher| bencher.iter(&mut work));
    }
}

criterion_group!(benches, all);
criterion_main!(benches);
