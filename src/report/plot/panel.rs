//! A frame with two axes. It computes positions itself, because the plot crate draws values outside an axis on its edge.
//! Here lines are clipped, points outside are left out, and error bars end in an arrow head where the frame cuts them.

use plotters::{prelude::RGBColor, style::text_anchor::HPos};

use super::{
    axis::Axis,
    canvas::{Canvas, Drawn, Place, Stroke, Words},
    look::{Curve, FAINT, GREY, GRID, Look, Point},
};

/// A frame with two axes.
pub struct Panel<'a, 'b> {
    page: &'a Canvas<'b>,
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    x: Axis,
    y: Axis,
}

impl<'a, 'b> Panel<'a, 'b> {
    /// Draws grid, frame, labels and title. `frame` is left, top, width, height; the labels are outside it.
    pub fn draw(
        page: &'a Canvas<'b>,
        title: &str,
        [left, top, width, height]: [f64; 4],
        x: Axis,
        y: Axis,
    ) -> Result<Self, Box<dyn std::error::Error>> {
        let panel = Self { page, left, top, width, height, x, y };
        let (right, bottom) = (left + width, top + height);
        let vertical = |v: f64| left + width * panel.x.position(v);
        let level = |v: f64| bottom - height * panel.y.position(v);
        let inside = |p: f64| (1e-6..=1.0 - 1e-6).contains(&p);

        for &v in panel.y.minor.iter().filter(|&&v| inside(panel.y.position(v))) {
            page.line((left, level(v)), (right, level(v)), Stroke::solid(FAINT, 1.0))?;
        }
        for (v, _) in panel.x.ticks.iter().filter(|(v, _)| inside(panel.x.position(*v))) {
            page.line((vertical(*v), top), (vertical(*v), bottom), Stroke::solid(GRID, 1.0))?;
        }
        for (v, _) in panel.y.ticks.iter().filter(|(v, _)| inside(panel.y.position(*v))) {
            page.line((left, level(*v)), (right, level(*v)), Stroke::solid(GRID, 1.0))?;
        }
        let axis = Stroke::solid(GREY, 1.0);
        for (from, to) in [
            ((left, top), (right, top)),
            ((right, top), (right, bottom)),
            ((right, bottom), (left, bottom)),
            ((left, bottom), (left, top)),
        ] {
            page.line(from, to, axis)?;
        }

        let label = Words { size: 12.5, ..Words::default() };
        for (v, words) in &panel.x.ticks {
            page.line((vertical(*v), bottom), (vertical(*v), bottom + 4.0), axis)?;
            page.text(words, (vertical(*v), bottom + 14.0), Words { align: HPos::Center, ..label })?;
        }
        for (v, words) in &panel.y.ticks {
            page.line((left - 4.0, level(*v)), (left, level(*v)), axis)?;
            page.text(words, (left - 8.0, level(*v)), Words { align: HPos::Right, ..label })?;
        }
        let title_words = Words { size: 14.0, bold: true, ..Words::default() };
        page.text(title, (left, top - 14.0), title_words)?;
        let middle = Words { align: HPos::Center, size: 13.0, ..Words::default() };
        page.text(&panel.x.title, (left + width / 2.0, bottom + 34.0), middle)?;
        page.text(&panel.y.title, (left - 54.0, top + height / 2.0), Words { upwards: true, ..middle })?;
        Ok(panel)
    }

    /// The position of a value, if it is inside the frame.
    fn at(&self, x: f64, value: f64) -> Option<Place> {
        let (u, v) = (self.x.position(x), self.y.position(value));
        ((0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v)).then(|| self.place(u, v))
    }

    fn place(&self, u: f64, v: f64) -> Place {
        (self.left + u * self.width, self.top + (1.0 - v) * self.height)
    }

    /// Draws the part of a line inside the frame. The line is straight on these axes.
    pub fn line(&self, from: (f64, f64), to: (f64, f64), stroke: Stroke) -> Drawn {
        let unit_square = |(x, y)| (self.x.position(x), self.y.position(y));
        match clip(unit_square(from), unit_square(to)) {
            Some((a, b)) => self.page.line(self.place(a.0, a.1), self.place(b.0, b.1), stroke),
            None => Ok(()),
        }
    }

    /// Draws a mark, if its position is inside the frame.
    pub fn mark(&self, x: f64, value: f64, look: Look) -> Drawn {
        self.at(x, value).map_or(Ok(()), |place| self.page.mark(place, look))
    }

    /// Draws a pale area in the colour of a curve. Corners outside the axes are left out.
    pub fn band(&self, corners: &[(f64, f64)], look: Look) -> Drawn {
        let places: Vec<Place> = corners.iter().filter_map(|&(x, v)| self.at(x, v)).collect();
        if places.len() < 3 { Ok(()) } else { self.page.tint(&places, look.color) }
    }

    /// Draws marks with 95 % error bars, and a thin line between them if `joined`. The marks are shifted sideways by `shift`
    /// pixels so that curves do not hide each other. On a logarithmic axis, an interval that reaches zero is drawn as an
    /// upper limit.
    pub fn curve(&self, curve: &Curve, shift: f64, joined: bool) -> Drawn {
        let color = curve.look.color;
        if joined {
            for pair in curve.points.windows(2).filter(|pair| pair.iter().all(|p| !self.is_limit(p))) {
                let thin = Stroke::solid(color, 1.2);
                self.line((pair[0].x, pair[0].value), (pair[1].x, pair[1].value), thin)?;
            }
        }
        for point in &curve.points {
            let half = point.half_width();
            if self.is_limit(point) {
                if let Some((x, y)) = self.at(point.x, point.value + half) {
                    let room = self.top + self.height - y;
                    self.page.limit((x + shift, y), room.min(22.0), color)?;
                }
            } else if let Some((x, y)) = self.at(point.x, point.value) {
                if half > 0.0 {
                    self.bar(x + shift, y, point.value, half, color)?;
                }
                self.page.mark((x + shift, y), curve.look)?;
            }
        }
        Ok(())
    }

    /// Returns true if a point can only be shown as an upper limit.
    pub fn is_limit(&self, point: &Point) -> bool {
        self.y.is_log() && point.value - point.half_width() <= 0.0
    }

    /// Draws the error bar of a mark at `(x, y)`: a cap at each end, or an arrow head where the frame cuts the bar.
    fn bar(&self, x: f64, y: f64, value: f64, half: f64, color: RGBColor) -> Drawn {
        let stroke = Stroke::solid(color, 1.4);
        for (end, outward) in [(value + half, -1.0), (value - half, 1.0)] {
            let v = self.y.position(end);
            let (_, tip) = self.place(0.0, v.clamp(0.0, 1.0));
            self.page.line((x, y), (x, tip), stroke)?;
            if (0.0..=1.0).contains(&v) {
                self.page.line((x - 3.5, tip), (x + 3.5, tip), stroke)?;
            } else {
                let base = tip - 7.0 * outward;
                self.page.polygon(&[(x - 4.0, base), (x + 4.0, base), (x, tip)], color)?;
            }
        }
        Ok(())
    }
}

/// The part of the segment from `a` to `b` inside the unit square (Liang and Barsky 1984).
fn clip(a: Place, b: Place) -> Option<(Place, Place)> {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (mut t0, mut t1) = (0.0f64, 1.0f64);
    for (speed, room) in [(-dx, a.0), (dx, 1.0 - a.0), (-dy, a.1), (dy, 1.0 - a.1)] {
        if !(speed.is_finite() && room.is_finite()) || (speed == 0.0 && room < 0.0) {
            return None;
        }
        if speed < 0.0 {
            t0 = t0.max(room / speed);
        } else if speed > 0.0 {
            t1 = t1.min(room / speed);
        }
    }
    (t0 <= t1).then_some(((a.0 + t0 * dx, a.1 + t0 * dy), (a.0 + t1 * dx, a.1 + t1 * dy)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clipping() {
        assert_eq!(clip((-1.0, 0.5), (2.0, 0.5)), Some(((0.0, 0.5), (1.0, 0.5))));
        assert_eq!(clip((0.2, 0.2), (0.4, 0.8)), Some(((0.2, 0.2), (0.4, 0.8))));
        assert_eq!(clip((0.2, 1.2), (0.4, 1.8)), None);
        assert_eq!(clip((0.5, 0.5), (0.5, f64::NAN)), None);
        assert_eq!(clip((0.5, 0.5), (0.5, f64::NEG_INFINITY)), None);
    }
}
