//! Recursion with N children at every vertex: the tree of rays, and their number by depth.
//!
//! ```text
//! (T L)(x) ≈ 1/N Σ_{c<N} weight_c · L(x'_c)          N^k rays estimate T^k E
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | N | children of every vertex | [`CHILDREN`] |
//! | k | depth in the tree: number of applications of T | |
//! | N^k | rays at depth k, counted by the estimator in a closed room | [`counted`] |
//! | T³E | its mean over the picture, from the tree with N = 3 and from single paths | [`means`] |
//!
//! Reference: Kajiya, *The Rendering Equation* (1986): one child is enough.

use super::page::{LEFT, SIZE, WIDTH, centred, heading, maths, paragraph, title, words};
use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Branching, Plan, Roulette, Technique};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::report::book::{Folder, Result, Slide};
use fredholm::report::image::typeset::superscript;
use fredholm::report::plot::{
    Axis, BLACK, BLUE, Canvas, Drawn, GREEN, GREY, Look, Mark, PURPLE, Panel, Place, Stroke, VERMILION, figure,
};
use fredholm::report::text::csv::Csv;
use fredholm::report::text::number::plus_minus;
use fredholm::scene::{Scene, load};

/// This figure.
pub const SLIDE: Slide = Slide {
    id: "recursion-tree",
    topic: "Naive recursion: the number of rays grows exponentially",
    caption: "Left: a function that calls itself three times at every vertex follows 27 rays after three reflections. \
              A path follows one branch of this tree, and its estimate has the same mean. Right: rays at depth k on a \
              logarithmic axis. With N children there are N to the power k, with one child always one.",
    scene: "sphere",
    program,
};

/// N, the depth up to which rays are counted, and the look of the curve.
const CHILDREN: [(u32, usize, Look); 4] = [
    (10, 5, Look { color: PURPLE, mark: Mark::Triangle }),
    (4, 8, Look { color: GREEN, mark: Mark::Diamond }),
    (2, 8, Look { color: BLUE, mark: Mark::Disk }),
    (1, 8, Look { color: VERMILION, mark: Mark::Square }),
];
/// Largest depth of the plot.
const DEEPEST: usize = 8;

/// Rays that the library's tree of paths traces at depth 0..=`deepest` for one sample of a pixel. In a closed room no ray is
/// lost.
fn counted(scene: &Scene, children: u32, deepest: usize, seed: u64) -> Vec<f64> {
    let plan = Plan { max_bounces: deepest, technique: Technique::Scatter, roulette: Roulette::Never };
    let amount = Amount { spp: 1, replicates: 1, key: Key::new(seed, "recursion tree") };
    let (t, tree) = (SceneTransport::new(scene), Branching { plan, children });
    let film = render(&t, &scene.camera, &tree, amount, fredholm::progress::Progress::NONE);
    let pixels = f64::from(scene.camera.size[0] * scene.camera.size[1]);
    film.rays[..=deepest].iter().map(|&rays| rays as f64 / pixels).collect()
}

/// Mean of T³E over the picture and its standard error: from the tree with three children, and from single paths.
fn means(folder: &Folder<'_>) -> Result<[[f64; 2]; 2]> {
    let size = load::Options { set: vec!["camera.size=[32, 32]".into()], ..Default::default() };
    let scene = Scene::new(&load::scene(SLIDE.scene, &size)?.description);
    let settings = Settings {
        spp: folder.pick(256, 64),
        seed: folder.seed,
        max_bounces: 3,
        technique: Technique::Scatter,
        roulette: Roulette::Never,
        ..Settings::default()
    };
    let found = [3, 1].map(|children| {
        let way = Estimator::Branching { children };
        let term = by_rays::terms(&scene, way, &settings, folder.progress).series.image().terms[3];
        // the three channels of this scene are equal
        [term.mean.x, term.std_error.x]
    });
    let [[tree, tree_error], [path, path_error]] = found;
    let error = tree_error.hypot(path_error);
    if (tree - path).abs() > 4.0 * error || error > 0.03 * path {
        return Err(format!("T³E is {tree} ± {tree_error} with a tree and {path} ± {path_error} with paths").into());
    }
    Ok(found)
}

fn program(folder: &Folder<'_>) -> Result<()> {
    let size = load::Options { set: vec!["camera.size=[2, 2]".into()], ..Default::default() };
    let scene = Scene::new(&load::scene(SLIDE.scene, &size)?.description);
    let mut csv = Csv::new("quantity,children,k,value,std_error");
    let mut curves = vec![];
    for (n, deepest, look) in CHILDREN {
        let last = if n == 10 { folder.pick(deepest, 3) } else { folder.pick(deepest, 5) };
        let rays = counted(&scene, n, last, folder.seed);
        for (k, &rays) in rays.iter().enumerate() {
            let predicted = f64::from(n).powi(k as i32);
            if rays != predicted {
                return Err(format!("{n} children: {rays} rays at depth {k} instead of {predicted}").into());
            }
            csv.put("rays per sample").put(n).put(k).numbers([rays, 0.0]).end();
        }
        curves.push((n, rays, look));
    }
    let found = means(folder)?;
    for (n, [mean, error]) in [3, 1].into_iter().zip(found) {
        csv.put("mean of T^k E").put(n).put(3).numbers([mean, error]).end();
    }
    let drawing = figure(SLIDE.id, WIDTH, 476, &folder.caption(SLIDE.scene), |page| {
        title(page, SLIDE.topic)?;
        tree(page, found)?;
        plot(page, &curves)
    })?;
    folder.figure(SLIDE.id, &drawing)?;
    folder.text("recursion-tree.csv", &csv.text())?;
    Ok(())
}

/// The tree with three children to depth 3, with one path highlighted.
fn tree(page: &Canvas<'_>, [tree, path]: [[f64; 2]; 2]) -> Drawn {
    const N: usize = 3;
    const DEPTH: usize = 3;
    /// The child that the highlighted path takes at every vertex.
    const PATH: [usize; DEPTH] = [1, 2, 0];
    let (left, width, top, step) = (LEFT + 20.0, 460.0, 110.0, 78.0);
    let place = |k: usize, i: usize| -> Place {
        let cells = N.pow(k as u32) as f64;
        (left + width * (i as f64 + 0.5) / cells, top + step * k as f64)
    };
    heading(page, "N = 3 children at every vertex", (LEFT, 64.0))?;
    for k in 0..DEPTH {
        for i in 0..N.pow(k as u32 + 1) {
            page.line(place(k, i / N), place(k + 1, i), Stroke::solid(GREY, 1.0))?;
        }
    }
    for k in 0..=DEPTH {
        (0..N.pow(k as u32)).try_for_each(|i| page.disk(place(k, i), 3.4, GREY))?;
        let (x, y) = (left + width + 8.0, place(k, 0).1);
        let rays = N.pow(k as u32);
        let label = format!("k = {k}:  3{} = {rays}", superscript(k));
        maths(page, &label, (x, y), words(SIZE, BLACK))?;
    }
    let mut at = 0;
    let mut before = place(0, 0);
    page.disk(before, 6.0, VERMILION)?;
    for (k, child) in PATH.into_iter().enumerate() {
        at = N * at + child;
        let next = place(k + 1, at);
        page.line(before, next, Stroke::solid(VERMILION, 3.5))?;
        page.disk(next, 6.0, VERMILION)?;
        before = next;
    }
    page.text("the eye sees x", (place(0, 0).0 + 14.0, top - 8.0), words(SIZE, GREY))?;
    let below = top + step * DEPTH as f64 + 36.0;
    let style = words(SIZE, BLACK);
    let text = "A path (orange) follows one child at every vertex: one ray per depth. Its throughput α carries the weight \
                f cos θ/p of every step.";
    let below = paragraph(page, text, (LEFT, below), 600.0, style)?;
    let of = |[mean, error]: [f64; 2]| plus_minus(mean, error, 1);
    let text =
        format!("The same mean: T³E = {} with the tree, {} with paths (± one standard error).", of(tree), of(path));
    paragraph(page, &text, (LEFT, below + 4.0), 600.0, style)?;
    Ok(())
}

/// Rays by depth: lines N^k, and marks where the library's tree was counted.
fn plot(page: &Canvas<'_>, curves: &[(u32, Vec<f64>, Look)]) -> Drawn {
    let x = Axis::counts("depth k (number of reflections)", DEEPEST, 9);
    let y = Axis::log("rays at depth k, per sample", [1.0, 1e8].into_iter());
    let (frame, heights) = ([694.0, 84.0, 222.0, 300.0], y.clone());
    let panel = Panel::draw(page, "Rays, N = 1, 2, 4, 10", frame, x, y)?;
    for (n, rays, look) in curves {
        let n = f64::from(*n);
        panel.line((0.0, 1.0), (DEEPEST as f64, n.powi(DEEPEST as i32)), Stroke::solid(look.color, 2.0))?;
        rays.iter().enumerate().try_for_each(|(k, &rays)| panel.mark(k as f64, rays, *look))?;
        let end = frame[1] + frame[3] * (1.0 - heights.position(n.powi(DEEPEST as i32)));
        page.text(&format!("{n}"), (frame[0] + frame[2] + 6.0, end), words(SIZE, look.color))?;
    }
    page.text("N", (frame[0] + frame[2] + 6.0, frame[1] - 14.0), words(SIZE, BLACK))?;
    page.text("marks: counted, lines: Nᵏ", (frame[0] + 0.5 * frame[2], 440.0), centred(12.5, GREY))
}
