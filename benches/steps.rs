//! Wall time of what a control loop repeats: `cargo bench --bench steps`.

mod work;

use criterion::{Criterion, criterion_group, criterion_main};

fn all(criterion: &mut Criterion) {
    for name in work::NAMES {
        let mut work = work::by_name(name).expect("every listed work has its name");
        criterion.bench_function(name, |bencher| bencher.iter(&mut work));
    }
}

criterion_group!(benches, all);
criterion_main!(benches);
