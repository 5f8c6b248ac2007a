//! Tables, plot and pictures of chapter 5: rays by depth, variance × rays, and pictures made with equal rays.
//!
//! | picture | shows | function |
//! |---|---|---|
//! | `price` | rays of depth k, and V C relative to N = 1, against N | [`plot`] |
//! | `equal_rays` | the terms k = 1 and k = 4 for N = 1, 2, 4, with equal numbers of rays | [`pictures`] |

use super::{CHILDREN, K, Measured, Tree, Value, load, plan, price};
use fredholm::estimator::Branching;
use fredholm::estimator::render::{Amount, render};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::report::book::{self, Folder};
use fredholm::report::half_width_95;
use fredholm::report::image::picture::{Picture, auto_gain, develop, mean};
use fredholm::report::image::sheet::{Layout, Tile, in_rows};
use fredholm::report::plot::{Axis, Curve, Entry, Figure, Look, Panel, Point, Sample, figure};
use fredholm::report::text::{
    markdown,
    number::{plus_minus, significant},
};
use fredholm::terms::{TermImage, scatter::Scatter};

/// Writes everything that the text includes.
pub(super) fn write(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let row = |k: usize| {
        let name = if k > K { "1 to 4 in one tree".to_string() } else { k.to_string() };
        [name, "1".into()].into_iter().chain((1..4).map(|i| times(price(&m.trees, i, k)))).collect::<Vec<_>>()
    };
    let rows: Vec<_> = (1..=K + 1).map(row).collect();
    folder.text("price.md", &markdown::table(&["k", "N = 1", "N = 2", "N = 4", "N = 8"], &rows))?;
    let row = |(n, tree): (&u32, &Tree)| {
        let all = tree.rays.iter().sum::<f64>();
        [n.to_string()].into_iter().chain(tree.rays.iter().chain([&all]).map(|&r| significant(r, 3))).collect()
    };
    let rows: Vec<Vec<String>> = CHILDREN.iter().zip(&m.trees).map(row).collect();
    folder.text("rays.md", &markdown::table(&["N", "k = 0", "k = 1", "k = 2", "k = 3", "k = 4", "all"], &rows))?;
    let all = |i: usize| m.trees[i].rays.iter().sum::<f64>();
    folder.numbers(&[
        ("more_rays", significant(all(3) / all(0), 2)),
        ("less_variance", significant(m.trees[0].variance[K + 1][0] / m.trees[3].variance[K + 1][0], 2)),
        ("last", percent(m.trees[3].rays[K] / all(3))),
        ("whole_2", times(price(&m.trees, 1, K + 1))),
        ("whole_8", times(price(&m.trees, 3, K + 1))),
        ("deep_2", times(price(&m.trees, 1, K))),
        ("small_4", times(price(&m.direct[0], 2, 1))),
        ("large_4", times(price(&m.direct[1], 2, 1))),
        ("star_small", times(best(&m.direct[0]))),
        ("star_large", times(best(&m.direct[1]))),
    ])?;
    folder.figure("price", &plot(m, folder)?)?;
    folder.picture("equal_rays.png", &pictures(m, folder)?)?;
    Ok(())
}

/// N* = √(a_1 c_0/(a_0 c_1)) for k = 1, with a_0 and a_1 from the variances for N = 1 and N = 8.
fn best(trees: &[Tree]) -> Value {
    let [[v_1, se_1], [v_8, se_8]] = [0, 3].map(|i| trees[i].variance[1]);
    let (a_0, a_1) = ((8.0 * v_8 - v_1) / 7.0, 8.0 * (v_1 - v_8) / 7.0);
    let star = (a_1 * trees[0].rays[0] / (a_0 * trees[0].rays[1])).sqrt();
    // d ln N* = ½ (d a_1/a_1 − d a_0/a_0), with d a_1 = 8/7 (d v_1 − d v_8) and d a_0 = (8 d v_8 − d v_1)/7
    let (by_1, by_8) = (8.0 / a_1 + 1.0 / a_0, -8.0 / a_1 - 8.0 / a_0);
    [star, star / 14.0 * (by_1 * se_1).hypot(by_8 * se_8)]
}

/// Left: rays of every depth. Right: V C relative to N = 1.
fn plot(m: &Measured, folder: &Folder<'_>) -> book::Result<Figure> {
    let n = |i: usize| f64::from(CHILDREN[i]);
    let curve = |k: usize, point: &dyn Fn(usize) -> Point| Curve {
        label: if k > K { "k = 1 to 4 in one tree".into() } else { format!("k = {k}") },
        points: (0..4).map(point).collect(),
        look: if k > K { Look::MATRIX } else { Look::nth(k - 1) },
    };
    let rays = |k: usize| curve(k, &|i| Point::exact(n(i), m.trees[i].rays[k]));
    let cost = |k: usize| {
        curve(k, &|i| {
            let [value, se] = price(&m.trees, i, k);
            let std_error = if i == 0 { 0.0 } else { se }; // 1, by definition
            Point { x: n(i), value, std_error, replicates: 32 }
        })
    };
    let (left, right): (Vec<Curve>, Vec<Curve>) = ((1..=K).map(rays).collect(), (1..=K + 1).map(cost).collect());
    let values = |curves: &[Curve]| curves.iter().flat_map(|c| c.points.iter().map(|p| p.value)).collect::<Vec<_>>();
    let axes = [Axis::powers_of_two("N, rays at every hit", (0..4).map(n), 4)];
    let up = |title: &str, curves: &[Curve]| Axis::log(title, values(curves).into_iter());
    let (rays, cost) = (up("rays per path", &left), up("variance × rays, relative to N = 1", &right));
    Ok(figure("price", 960, 420, &folder.caption("cornell"), |page| {
        let panel = Panel::draw(page, "Rays of depth k", [80.0, 40.0, 310.0, 320.0], axes[0].clone(), rays)?;
        left.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;
        let panel = Panel::draw(page, "Rays for the same error", [490.0, 40.0, 310.0, 320.0], axes[0].clone(), cost)?;
        right.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;
        let entries: Vec<_> = right.iter().map(|c| Entry::new(Sample::Mark(c.look), &c.label)).collect();
        page.legend((816.0, 60.0), 130.0, &entries)?;
        Ok(())
    })?)
}

/// The terms k = 1 and k = 4 with N = 1, 2, 4 and equal numbers of rays.
fn pictures(m: &Measured, folder: &Folder<'_>) -> book::Result<Picture> {
    let side = folder.pick(128, 64);
    let scene = load("cornell", side)?;
    let all = |i: usize| m.trees[i].rays.iter().sum::<f64>();
    let film = |i: usize| {
        let spp = (4.0 * all(2) / all(i)).round() as u32;
        let amount = Amount::new(spp, Key::new(folder.seed, "equal rays").branch(CHILDREN[i]));
        let tree = Branching { plan: plan(K), children: CHILDREN[i] };
        (i, spp, render(&SceneTransport::new(&scene), &scene.camera, &tree, amount, folder.progress))
    };
    let films = [0, 1, 2].map(film);
    let mut tiles = vec![];
    for k in [1, K] {
        let gain = auto_gain(&TermImage::of(&films[0].2, k..k + 1).mean);
        for (i, spp, film) in &films {
            let term = TermImage::of(film, k..k + 1).mean;
            let noise = Scatter::of(film, k..k + 1, None).variance().sqrt() / mean(&term);
            let image = develop(side as usize, side as usize, &term, gain).picture;
            tiles.push(Tile {
                image: image.enlarged(512 / side as usize),
                label: format!("N = {}: {spp} paths per pixel", CHILDREN[*i]),
                notes: vec![format!("standard error {} of the mean", percent(noise))],
            });
        }
    }
    let heads = [["k = 1", "direct light"], ["k = 4", "4 reflections"]].map(|words| words.map(String::from));
    let layout = Layout {
        title: "The same number of rays, spent on trees with N = 1, 2 and 4 rays at every hit",
        tiles: &tiles,
        places: &in_rows(6, 3),
        heads: &heads,
        foot: None,
        scale: 2.0,
    };
    Ok(layout.draw(&folder.caption("cornell"))?)
}

/// Value ± half a 95 % interval.
pub(super) fn times([value, std_error]: Value) -> String {
    plus_minus(value, half_width_95(std_error, 32), 1)
}
/// In percent, with two digits.
pub(super) fn percent(x: f64) -> String {
    format!("{} %", significant(100.0 * x, 2))
}
