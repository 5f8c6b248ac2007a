//! Plots: nothing is drawn outside a frame, and figures are reproducible.

use super::*;

/// Numbers of an attribute in every element of one kind.
fn attribute<'a>(element: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = element.split_once(&format!(" {name}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}

/// Places (in CSS pixels) of everything drawn in the colours of data.
fn data_places(figure: &Figure, colors: &[&str]) -> Vec<(f64, f64)> {
    let mut places = Vec::new();
    for element in figure.svg.split('<').filter(|e| colors.iter().any(|c| e.contains(c))) {
        let number = |name| attribute(element, name).and_then(|v| v.parse::<f64>().ok());
        if let (Some(x), Some(y)) = (number("cx"), number("cy")) {
            places.push((x / 10.0, y / 10.0));
        }
        for (x, y) in [("x1", "y1"), ("x2", "y2")] {
            places.extend(number(x).zip(number(y)).map(|(x, y)| (x / 10.0, y / 10.0)));
        }
        let points = attribute(element, "points").unwrap_or_default();
        places.extend(points.split_whitespace().filter_map(|pair| {
            let (x, y) = pair.split_once(',')?;
            Some((x.parse::<f64>().ok()? / 10.0, y.parse::<f64>().ok()? / 10.0))
        }));
    }
    places
}

const BLUE: &str = "#0072B2";
const GREEN: &str = "#009E73";

/// A curve with values an axis cannot hold: zero, negative, NaN, infinite, an upper limit, a huge error bar, and lines
/// that leave the panel on every side.
#[test]
fn nothing_is_drawn_outside_a_frame() {
    let at = |x: f64, value: f64, std_error: f64| Point { x, value, std_error, replicates: 16 };
    let points = vec![
        at(0.0, 1.0, 0.01),
        at(1.0, 0.5, 0.01),
        at(2.0, 0.25, 0.117),
        at(3.0, -0.01, 0.02),
        at(4.0, 0.0, 0.0),
        at(5.0, f64::NAN, 0.1),
        at(6.0, f64::INFINITY, 0.1),
        at(7.0, 0.1, f64::INFINITY),
        at(8.0, 0.02, 0.001),
    ];
    let line = |value, ratio| RateLine { label: "line".into(), k0: 0.0, value, ratio, kind: RateKind::Guaranteed };
    let decay = Decay {
        title: "hard".into(),
        ratios: vec![curve(independent_ratios(&points))],
        image: vec![curve(points.clone())],
        surface: vec![curve(points)],
        lines: vec![line(1.0, 3.0), line(1.0, 0.01), line(1.0, 0.0), line(1.0, f64::NAN)],
    };
    let figure = decay::draw(&decay, &caption()).unwrap();
    // Frames of the three panels and the column of the legend, in CSS pixels, with the width of a mark.
    let boxes = [[84.0, 72.0, 540.0, 350.0], [84.0, 504.0, 372.0, 220.0], [552.0, 504.0, 372.0, 220.0]];
    let inside = |(x, y): (f64, f64)| {
        let within = |[left, top, w, h]: [f64; 4]| {
            (left - 6.0..=left + w + 6.0).contains(&x) && (top - 0.1..=top + h + 0.1).contains(&y)
        };
        boxes.into_iter().any(within) || x > 640.0 && y < 460.0
    };
    let places = data_places(&figure, &[BLUE, GREEN]);
    assert!(places.len() > 40, "only {} places: the test sees nothing", places.len());
    for place in places {
        assert!(inside(place), "{place:?} is outside every frame");
    }
    // Marks of the surface panel: k = 0, 1, 2, 8 (2 still reaches above zero); 3 and 7 have no finite or positive place.
    let disks = figure.svg.split('<').filter(|e| e.starts_with("circle") && e.contains(BLUE));
    let upper =
        disks.filter_map(|e| Some((attribute(e, "cx")?.parse::<f64>().ok()?, attribute(e, "cy")?.parse().ok()?)));
    let upper: Vec<(f64, f64)> = upper.filter(|&(x, y): &(f64, f64)| x < 6300.0 && y < 4300.0).collect();
    assert_eq!(upper.len(), 4, "{upper:?}");
}

#[test]
fn figures_are_reproducible_and_drawn_at_twice_the_size() {
    let folder = tempfile::tempdir().unwrap();
    let points = (0..8).map(|e| Point { x: 2f64.powi(e), value: 0.5f64.powi(e), std_error: 0.01, replicates: 16 });
    let falling = Falling { curve: curve(points.collect()), slope: Some((-1.0, 0.02)) };
    let variance = Variance { title: "a < b & c".into(), curves: vec![falling] };
    let figure = variance::draw(&variance, &caption()).unwrap();
    assert_eq!(figure, variance::draw(&variance, &caption()).unwrap());
    let [svg, png] = figure.write(folder.path(), "variance").unwrap();
    let read = image::open(png).unwrap();
    assert_eq!((read.width(), read.height()), (2 * figure.width, 2 * figure.height));
    let text = std::fs::read_to_string(svg).unwrap();
    assert!(text.contains(&format!("width=\"{}\" height=\"{}\"", figure.width, figure.height)));
    assert!(text.contains("a &lt; b &amp; c") && text.contains("slope\u{a0}−1.000\u{a0}±\u{a0}0.020"));
    assert!(text.contains("fredholm series cornell --spp 16 --seed 3"));
    assert!(!text.contains("font-family=\"DejaVu Sans\""), "every family has a fallback");
}
