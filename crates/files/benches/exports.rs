//! What it takes to hand a long trajectory on: two Panda arms, 100,000 samples, every format, and reading them back.

use std::hint::black_box;
use std::io::{self, Write};

use criterion::{Criterion, criterion_group, criterion_main};
use kinstep_files::scenario::ScenarioText;
use kinstep_files::trajectory::{ArmTrajectory, Export, Recording, Stage, Trajectory};

const SAMPLES: usize = 100_000;

/// Two arms that swing, each joint at its own pace, and come to rest.
fn trajectory(stage: &Stage) -> Trajectory {
    let duration = (SAMPLES - 1) as f64 * 0.001;
    let times: Vec<f64> = (0..SAMPLES).map(|n| n as f64 * 0.001).collect();
    let arm = |name: &String, joints: Vec<String>| {
        let rate = |joint: usize| f64::from(joint as u32 + 1) * std::f64::consts::PI / duration;
        let swing = |f: fn(f64) -> f64, scale: bool| {
            let entry =
                move |t: f64, joint: usize| f(rate(joint) * t) * if scale { rate(joint) } else { 1.0 };
            times
                .iter()
                .flat_map(|&t| (0..joints.len()).map(move |joint| entry(t, joint)))
                .collect::<Vec<f64>>()
        };
        let positions = swing(|angle| 0.3 * angle.sin().powi(2), false);
        let mut velocities = swing(|angle| 0.3 * (2.0 * angle).sin(), true);
        let end = velocities.len() - joints.len();
        velocities[end..].fill(0.0);
        let errors = times.iter().map(|t| 1e-9 * t.cos().abs()).collect();
        let (name, accelerations) = (name.clone(), Vec::new());
        ArmTrajectory { name, joints, positions, velocities, accelerations, errors }
    };
    let arms = stage.arms.iter().map(|staged| {
        arm(&staged.name, staged.chain.joints().iter().map(|joint| joint.name.clone()).collect())
    });
    let arms = arms.collect();
    Trajectory { about: None, times, arms }
}

/// Counts bytes, as a disk without limits would take them.
struct Count(u64);

impl Write for Count {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 += bytes.len() as u64;
        Ok(black_box(bytes).len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn exports(criterion: &mut Criterion) {
    let text = ScenarioText::parse(include_str!("../../../examples/dual_panda.toml"));
    let stage = text.and_then(|text| text.scenario()?.stage(None)).expect("the example is sound");
    let trajectory = trajectory(&stage);
    let recording = Recording { trajectory: &trajectory, stage: &stage };
    let machines = recording.machines();
    let mut group = criterion.benchmark_group("exports of 100,000 samples of two arms");
    group.sample_size(10);
    for format in Export::ALL {
        group.bench_function(format.name(), |bencher| {
            bencher.iter(|| {
                let mut count = Count(0);
                for file in format.files(&machines) {
                    file.format.check(recording).expect("the trajectory ends at rest");
                    let mut out = io::BufWriter::new(&mut count);
                    file.format.write(recording, &mut out).expect("counting does not fail");
                }
                count.0
            });
        });
    }
    for format in [Export::Csv, Export::Npz, Export::Mcap] {
        let file = format.files(&machines).swap_remove(0);
        let mut bytes = Vec::new();
        file.format.write(recording, &mut bytes).expect("a vector takes every byte");
        group.bench_function(format!("read {}", format.name()), |bencher| {
            bencher.iter(|| Trajectory::from_bytes(file.name.as_ref(), &bytes).map(|read| read.samples()));
        });
    }
    group.finish();
}

criterion_group!(benches, exports);
criterion_main!(benches);
