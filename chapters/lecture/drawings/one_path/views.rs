//! The room from above and from the side, with a path in it.
//!
//! ```text
//! from above: (x, y, z) ↦ (x, −z)          from the side: (x, y, z) ↦ (−z, y)          in the picture: the camera
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | outline | edges of walls, blocks and lamp | [`outline`] |
//! | path | segments, vertices x_0, x_1, …, and the rays to the lamp, dashed where hidden | [`path`] |
//!
//! Reference: Foley, van Dam, Feiner, Hughes, *Computer Graphics: Principles and Practice* (2nd ed. 1990), ch. 6.

use super::super::page::View;
use super::walk::Visit;
use fredholm::report::plot::{Align, BLACK, Canvas, Drawn, GREY, ORANGE, Place, Stroke, VERMILION, Words};
use fredholm::scene::Description;
use fredholm::scene::description::{Geometry, Shape};
use glam::{DVec3, Vec3};
use plotters::style::WHITE;

/// Edges of a shape as pairs of points.
fn edges(shape: &Shape) -> Vec<[DVec3; 2]> {
    match &shape.geometry {
        Geometry::Quad { origin, edge_u, edge_v } => {
            let c = [*origin, origin + edge_u, origin + edge_u + edge_v, origin + edge_v];
            (0..4).map(|i| [c[i], c[(i + 1) % 4]]).collect()
        }
        Geometry::Box { min, max, rotate_y, .. } => {
            let middle = 0.5 * (min + max);
            let turn = glam::DQuat::from_rotation_y(rotate_y.to_radians());
            let corner = |i: usize| {
                let pick = |bit: usize, lo: f64, hi: f64| if (i >> bit) & 1 == 0 { lo } else { hi };
                let p = DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
                middle + turn * (p - middle)
            };
            let pairs = (0..8).flat_map(|i| (0..3).map(move |bit| (i, i ^ (1 << bit))));
            pairs.filter(|(i, j)| i < j).map(|(i, j)| [corner(i), corner(j)]).collect()
        }
        _ => vec![],
    }
}

/// Draws the edges of all shapes; the lamp is thick and orange.
pub fn outline(page: &Canvas<'_>, room: &Description, origin: DVec3, view: &View) -> Drawn {
    for shape in &room.shapes {
        let lamp = shape.emission != DVec3::ZERO;
        let stroke = if lamp { Stroke::solid(ORANGE, 4.5) } else { Stroke::solid(GREY, 1.3) };
        for [a, b] in edges(shape) {
            let ends = [view.at(a - origin), view.at(b - origin)];
            if (ends[0].0 - ends[1].0).hypot(ends[0].1 - ends[1].1) > 0.5 {
                page.line(ends[0], ends[1], stroke)?;
            }
        }
    }
    Ok(())
}

/// Draws a path: the ray of the eye from `eye`, the segments, the rays to the lamp, and the numbered vertices. Without `eye`
/// it lies over a picture, and every line has a white edge.
pub fn path(page: &Canvas<'_>, visits: &[Visit], eye: Option<Place>, at: &dyn Fn(Vec3) -> Place) -> Drawn {
    let line = |from: Place, to: Place, stroke: Stroke| {
        if eye.is_none() {
            page.line(from, to, Stroke { color: WHITE, width: stroke.width + 2.4, ..stroke })?;
        }
        page.line(from, to, stroke)
    };
    for v in visits {
        let dash = v.shadow.adds.is_none().then_some((6.0, 4.0));
        let color = if v.shadow.adds.is_some() { ORANGE } else { BLACK };
        line(at(v.at.p), at(v.shadow.end), Stroke { color, width: 2.2, dash })?;
        if v.shadow.adds.is_none() {
            let (x, y) = at(v.shadow.end);
            for (dx, dy) in [(5.0, 5.0), (5.0, -5.0)] {
                line((x - dx, y - dy), (x + dx, y + dy), Stroke::solid(BLACK, 2.4))?;
            }
        }
    }
    let vertices: Vec<Place> = visits.iter().map(|v| at(v.at.p)).collect();
    let all: Vec<Place> = eye.into_iter().chain(vertices.iter().copied()).collect();
    for pair in all.windows(2) {
        line(pair[0], pair[1], Stroke::solid(VERMILION, 3.0))?;
    }
    for (i, &place) in vertices.iter().enumerate() {
        page.disk(place, 11.0, WHITE)?;
        page.disk(place, 9.6, VERMILION)?;
        let words = Words { align: Align::Center, bold: true, size: 13.5, color: WHITE, ..Words::default() };
        page.text(&i.to_string(), (place.0, place.1 + 0.5), words)?;
    }
    Ok(())
}
