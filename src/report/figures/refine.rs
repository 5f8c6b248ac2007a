//! Convergence of the radiosity with the patch width h: tables, curves, and maps of the error.
//!
//! ```text
//! |e_h| against h on logarithmic axes, order p = slope        (R_h − R)/R of each tile, blue too dark, red too bright
//! ```

use crate::engine::radius::{Radius, radius_limit};
use crate::report::{
    ReportError,
    image::{
        contact_sheet::{self, Cell, Sheet},
        typeset::{Caption, superscript},
    },
    plot::{Axis, Canvas, Curve, Drawn, Entry, Figure, GREY, Look, Panel, Point, Sample, Stroke, Words, figure},
    text::{
        csv::Csv,
        number::significant,
        table::{Side, aligned},
    },
};
use crate::stats::{Limit, Order, convergence_order};
use crate::study::refinement::{Mesh, Quantity, Refinement};

/// The small table, a row per quantity of `quantities`: the value by rays, the error of the image mean in percent of it on each
/// of the finest `meshes` meshes (± standard error), and the fitted order.
pub fn table(r: &Refinement, quantities: &[Quantity], meshes: usize) -> String {
    let shown = &r.meshes[r.meshes.len().saturating_sub(meshes)..];
    let mut header: Vec<String> = ["", "by rays"].map(String::from).to_vec();
    header.extend(shown.iter().map(|m| format!("{} patches", m.patches)));
    header.push("order in h".into());
    let mut rows = vec![header];
    for &q in quantities {
        let truth = q.mean(&r.truth).mean.element_sum() / 3.0;
        let mut row = vec![q.to_string(), significant(truth, 4)];
        row.extend(shown.iter().map(|m| {
            let (e, s) = r.mean_error(m, q);
            percent(e / truth, s / truth)
        }));
        row.push(order_words(order(r, q)));
        rows.push(row);
    }
    aligned(&rows, &[[Side::Left].as_slice(), &vec![Side::Right; shown.len() + 2]].concat())
}

/// A relative error with its standard error, in percent.
pub fn percent(error: f64, std_error: f64) -> String {
    let (error, std_error) = (100.0 * error, 100.0 * std_error);
    match (error.is_finite(), std_error.is_finite()) {
        (false, _) => "–".into(),
        (true, false) => format!("{error:+.2} ± – %"),
        (true, true) => format!("{error:+.2} ± {std_error:.2} %"),
    }
}

/// The order of convergence of the image mean in h, if two or more errors exceed 3 standard errors and have one sign.
pub fn order(r: &Refinement, quantity: Quantity) -> Option<Order> {
    orders(r, &|m, q| r.mean_error(m, q), quantity)
}

/// The full table, a row per quantity: the error of the image mean on every mesh with the fitted order, and the same for the
/// error over the image.
pub fn full_table(r: &Refinement, max_bounces: usize) -> String {
    let mut header: Vec<String> = ["", "truth"].map(String::from).to_vec();
    header.extend(r.meshes.iter().map(|m| m.patches.to_string()));
    header.push("order in h".into());
    let truth = |q: Quantity| significant(q.mean(&r.truth).mean.element_sum() / 3.0, 4);
    let rows_of = |quantities: &[Quantity], error: &Error| {
        let mut rows = vec![header.clone()];
        rows.extend(quantities.iter().map(|&q| {
            let mut row = vec![q.to_string(), truth(q)];
            row.extend(r.meshes.iter().map(|m| {
                let (e, s) = error(m, q);
                format!("{} ± {}", significant(e, 2), significant(s, 1))
            }));
            row.push(order_words(orders(r, error, q)));
            row
        }));
        aligned(&rows, &[[Side::Left].as_slice(), &vec![Side::Right; r.meshes.len() + 2]].concat())
    };
    let mesh = |m: &Mesh| {
        format!(
            "{}: h = {:.3} m, ρ(T_h) = ({:.5}, {:.5}, {:.5}), {:.1} s",
            m.patches, m.h, m.radius.value.x, m.radius.value.y, m.radius.value.z, m.seconds
        )
    };
    let all = Quantity::all(max_bounces);
    let means = rows_of(&all, &|m, q| r.mean_error(m, q));
    let images = rows_of(&all[..=max_bounces], &|m, q| image_error(r, m, q));
    format!(
        "{}{}\n\nError of the image mean by number of patches (± standard error).\n{means}\nError over the image ‖R_h − R‖/‖R‖, with the noise subtracted; a negative one is hidden by noise.\n{images}",
        r.meshes.iter().map(mesh).collect::<Vec<_>>().join("\n"),
        limit_words(&r.meshes.iter().map(|m| m.radius).collect::<Vec<_>>()).map_or(String::new(), |l| format!("\n{l}"))
    )
}

/// The spectral radius extrapolated to h → 0 from meshes, coarsest first, with its half width and its orders; `None` with one
/// mesh.
pub fn limit_words(meshes: &[Radius]) -> Option<String> {
    let Some(limit) = radius_limit(meshes) else {
        let coarse = meshes.iter().nth_back(1).is_some_and(|m| !m.resolved);
        return coarse
            .then(|| "not extrapolated to h → 0: the coarser mesh has fewer than three patches to a face".into());
    };
    let each = |f: &dyn Fn(&Limit) -> String| limit.each_ref().map(f).join(", ");
    Some(format!(
        "extrapolated to h → 0: ({})\n±({}), for orders {} in h; an estimate, no bound",
        each(&|l| format!("{:.5}", l.value)),
        each(&|l| format!("{:.0e}", l.half_width)),
        each(&|l| format!("{:.1} to {:.1}", l.orders[0], l.orders[1])),
    ))
}

/// An error with its standard error.
type Error<'a> = dyn Fn(&Mesh, Quantity) -> (f64, f64) + 'a;

/// The error of a term over the image with its standard error; NaN for a sum, whose error is not known.
fn image_error(r: &Refinement, mesh: &Mesh, quantity: Quantity) -> (f64, f64) {
    match quantity {
        Quantity::Term(k) => r.image_error(mesh, k),
        Quantity::Indirect => (f64::NAN, f64::NAN),
    }
}

fn orders(r: &Refinement, error: &Error, q: Quantity) -> Option<Order> {
    let points: Vec<(f64, f64, f64)> = r
        .meshes
        .iter()
        .map(|m| {
            let (e, s) = error(m, q);
            (m.h, e, s)
        })
        .collect();
    convergence_order(&points)
}

fn order_words(order: Option<Order>) -> String {
    order.map_or("–".into(), |o| format!("{:.2} ± {:.2}", o.order, o.std_error))
}

/// All numbers as CSV, a line per mesh and quantity.
pub fn csv(r: &Refinement, max_bounces: usize) -> String {
    let mut csv = Csv::new(
        "patches,h,k,mean_error,mean_error_std_error,image_error,image_error_std_error,radius_r,radius_g,radius_b,seconds",
    );
    for m in &r.meshes {
        for q in Quantity::all(max_bounces) {
            let ((e, s), (i, t)) = (r.mean_error(m, q), image_error(r, m, q));
            csv.put(m.patches).put(m.h).put(q).put(e).put(s).numbers([i, t]);
            m.radius.value.to_array().into_iter().for_each(|x| _ = csv.put(x));
            csv.put(m.seconds).end();
        }
    }
    csv.text()
}

/// Draws |e_h| of the image mean, and ‖R_h − R‖/‖R‖, against h.
///
/// # Errors
/// If the plot crate fails, which is a defect.
pub fn draw(r: &Refinement, max_bounces: usize, caption: &Caption) -> Result<Figure, ReportError> {
    figure("patches", 1120, 490, caption, |page| panels(page, r, max_bounces))
}

/// The quantities that are drawn: k = 2 to at most 5, and their sum with all longer ones. T⁰ and T¹ need no matrix.
fn shown(max_bounces: usize) -> Vec<Quantity> {
    (2..=max_bounces.min(5)).map(Quantity::Term).chain([Quantity::Indirect]).collect()
}

fn panels(page: &Canvas, r: &Refinement, max_bounces: usize) -> Drawn {
    page.text(
        "Finer meshes: how fast the matrix comes near the truth",
        (24.0, 24.0),
        Words { size: 18.0, ..Words::default() },
    )?;
    let replicates = r.truth.series.image().total.replicates;
    let curves = |error: &Error| -> Vec<Curve> {
        let point = |m: &Mesh, q: Quantity| {
            let (e, std_error) = error(m, q);
            Point { x: m.h, value: e.abs(), std_error, replicates }
        };
        let curve = |(i, q): (usize, Quantity)| {
            let name = match q {
                Quantity::Term(k) => format!("T{}E", superscript(k)),
                Quantity::Indirect => "all k ≥ 2".into(),
            };
            Curve { label: name, points: r.meshes.iter().map(|m| point(m, q)).collect(), look: Look::nth(i) }
        };
        shown(max_bounces).into_iter().enumerate().map(curve).collect()
    };
    let (means, images) = (curves(&|m, q| r.mean_error(m, q)), curves(&|m, q| image_error(r, m, q)));
    let guide = Stroke { color: GREY, width: 1.6, dash: Some((7.0, 5.0)) };
    let panels = [
        ([84.0, 72.0, 372.0, 350.0], "Error of the image mean", "|e|   (W sr⁻¹ m⁻²)", &means),
        ([552.0, 72.0, 372.0, 350.0], "Error over the image", "‖R_h − R‖ / ‖R‖", &images),
    ];
    for (frame, title, unit, curves) in panels {
        let points = || curves.iter().flat_map(|c| &c.points);
        let x = Axis::log("width of a patch h (m)", points().map(|p| p.x));
        let panel = Panel::draw(
            page,
            title,
            frame,
            x,
            Axis::log(unit, points().flat_map(|p| [p.value, p.value + p.half_width()])),
        )?;
        let top = points().max_by(|a, b| a.value.total_cmp(&b.value));
        if let Some(top) = top {
            let at = |x: f64| (x, 1.5 * top.value * x / top.x);
            panel.line(at(0.01 * top.x), at(10.0 * top.x), guide)?;
        }
        curves.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;
    }
    let of = |q: Quantity| order_words(orders(r, &|m, q| image_error(r, m, q), q));
    let mut entries = vec![Entry::new(Sample::Heading, "bars: 95 %")];
    entries.extend(means.iter().map(|c| Entry::new(Sample::Mark(c.look), &c.label)));
    entries.push(Entry::new(Sample::Line(guide), "slope 1"));
    entries.push(Entry::new(Sample::Heading, "order, image"));
    entries.extend(shown(max_bounces).into_iter().zip(&means).map(|(q, c)| Entry::new(Sample::Mark(c.look), of(q))));
    page.legend((944.0, 68.0), 160.0, &entries)?;
    Ok(())
}

/// Pixels of a side of a tile.
const TILE: usize = 4;

/// Draws the error (R_h − R)/R̄ of all indirect light for each mesh, averaged over tiles. Red is too bright, blue is too dark;
/// the colour is full at `range`.
///
/// # Errors
/// If the text cannot be drawn, which is a defect.
pub fn places(r: &Refinement, [w, h]: [usize; 2], range: f64, caption: &Caption) -> Result<Sheet, ReportError> {
    // indirect light: what a matrix is asked for
    let indirect = |s: &crate::engine::by_rays::Sampled, i: usize| -> f64 {
        let direct: f64 = s.terms.iter().take(2).flat_map(|t| t.mean[i]).map(f64::from).sum();
        s.total.mean[i].iter().map(|&x| f64::from(x)).sum::<f64>() - direct
    };
    let average = (0..w * h).map(|i| indirect(&r.truth, i)).sum::<f64>() / (w * h) as f64;
    let images: Vec<Vec<[f32; 3]>> = r
        .meshes
        .iter()
        .map(|m| {
            let (columns, rows) = (w.div_ceil(TILE), h.div_ceil(TILE));
            let mut tiles = vec![(0.0, 0.0); columns * rows];
            for i in 0..w * h {
                let t = &mut tiles[i / w / TILE * columns + i % w / TILE];
                t.0 += indirect(&m.picture, i) - indirect(&r.truth, i);
                t.1 += 1.0;
            }
            let colour = |i: usize| {
                let (sum, n) = tiles[i / w / TILE * columns + i % w / TILE];
                signed((sum / n / average / range).clamp(-1.0, 1.0) as f32)
            };
            // twice the size: a tile is eight pixels wide
            (0..4 * w * h).map(|i| colour(i / (2 * w) / 2 * w + i % (2 * w) / 2)).collect()
        })
        .collect();
    let cells: Vec<Cell> = r
        .meshes
        .iter()
        .zip(&images)
        .map(|(m, pixels)| Cell { label: format!("{} patches", m.patches), pixels, gain: Some(1.0) })
        .collect();
    let title = format!(
        "Where the mesh fails: indirect light too bright (red) or too dark (blue); full colour is {:.0} % of its mean",
        100.0 * range
    );
    let notes: Vec<Vec<String>> = r.meshes.iter().map(|m| vec![format!("h = {:.3} m", m.h)]).collect();
    contact_sheet::annotated(&title, 2 * w, 2 * h, &cells, &notes, caption)
}

/// White at 0, red at 1, blue at −1, in linear light.
fn signed(x: f32) -> [f32; 3] {
    let fade = 1.0 - x.abs();
    if x >= 0.0 { [1.0, fade, fade] } else { [fade, fade, 1.0] }
}
