//! Instructions per path: `cargo bench --bench instructions [-- --update]`. Needs `valgrind`, on Linux.
//!
//! Callgrind counts the instructions of each kernel for two numbers of samples; the difference, divided by the paths between
//! them, is the cost of a path without the cost of starting. The count is the same on a busy and on an idle machine, so a
//! change that makes a kernel slower is seen without a clock. Callgrind knows AVX2 but not AVX-512, so the counts are those
//! of AVX2.
//!
//! Every count is compared with `benches/instructions.csv`. The run fails if one is larger by more than 5 %. `--update`
//! writes the new counts, which belong into the commit that explains them.
#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]

use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Bidirectional, LightTracer, PathTracer, Plan, Prefix, Roulette, Technique};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::progress::Progress;
use fredholm::scene::{Scene, load};
use std::process::{Command, ExitCode, exit};

/// Kernels: an estimator in a built-in scene.
const KERNELS: [(&str, &str); 9] = [
    ("prefix", "cornell"),
    ("prefix", "cornell-spheres"),
    ("prefix", "env-ggx"),
    ("prefix", "veach-mis"),
    ("prefix", "caustic"),
    ("prefix", "many-lights"),
    ("path", "cornell"),
    ("light", "cornell"),
    ("bidirectional", "cornell"),
];
const SIZE: u32 = 32;
const SPP: [u32; 2] = [16, 48];
/// Largest allowed growth of a count.
const ALLOWED: f64 = 1.05;
const RECORDED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/instructions.csv");

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    if let [estimator, scene, spp] = args.as_slice() {
        kernel(estimator, scene, spp.parse().unwrap());
        return ExitCode::SUCCESS;
    }
    let update = args.iter().any(|a| a == "--update");
    let recorded = std::fs::read_to_string(RECORDED).unwrap_or_default();
    let (mut table, mut slower) = ("estimator,scene,instructions per path\n".to_owned(), false);
    println!("instructions per path: recorded, now, ratio");
    for (estimator, scene) in KERNELS {
        let [few, many] = SPP.map(|spp| instructions(estimator, scene, spp));
        let now = (many - few) / f64::from(SIZE * SIZE * (SPP[1] - SPP[0]));
        let row = format!("{estimator},{scene},");
        let before = recorded.lines().find_map(|l| l.strip_prefix(&row)?.parse::<f64>().ok());
        match before {
            Some(before) => {
                let (ratio, mark) = (now / before, if now > ALLOWED * before { "  slower" } else { "" });
                slower |= now > ALLOWED * before;
                println!("{estimator:14} {scene:16} {before:8.0} {now:8.0} {ratio:6.3}{mark}");
            }
            None => {
                slower = true;
                println!("{estimator:14} {scene:16}        – {now:8.0}  no record");
            }
        }
        table += &format!("{row}{now:.0}\n");
    }
    if update {
        std::fs::write(RECORDED, table).unwrap();
        return ExitCode::SUCCESS;
    }
    ExitCode::from(u8::from(slower))
}

/// Instructions of one kernel, from its start to its end.
fn instructions(estimator: &str, scene: &str, spp: u32) -> f64 {
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).arg(std::env::current_exe().unwrap());
    let Ok(run) = valgrind.args([estimator, scene, &spp.to_string()]).output() else {
        println!("valgrind is not installed");
        exit(2);
    };
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    let count = said.lines().find_map(|l| l.split_once("Collected : ")?.1.trim().parse().ok());
    count.unwrap_or_else(|| {
        println!("valgrind counted nothing:\n{said}");
        exit(2)
    })
}

/// Renders one kernel with one thread.
fn kernel(estimator: &str, scene: &str, spp: u32) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().unwrap();
    let mut d = load::scene(scene, &load::Options::default()).unwrap().description;
    d.camera.size = [SIZE; 2];
    let scene = Scene::new(&d);
    let (t, camera) = (SceneTransport::new(&scene), &scene.camera);
    let plan = Plan { max_bounces: 8, technique: Technique::Mis, roulette: Roulette::Never };
    let amount = Amount::new(spp, Key::new(0, estimator));
    let film = match estimator {
        "prefix" => render(&t, camera, &Prefix(plan), amount, Progress::NONE),
        "light" => render(&t, camera, &LightTracer(plan), amount, Progress::NONE),
        "bidirectional" => render(&t, camera, &Bidirectional(plan), amount, Progress::NONE),
        _ => render(&t, camera, &PathTracer(plan), amount, Progress::NONE),
    };
    std::hint::black_box(film);
}
