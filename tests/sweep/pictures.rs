//! `pictures.png`: every value at one exposure, in panels of at least 256 pixels; plots join no values that have no order.

use super::*;
use fredholm::report::image::picture::{Picture, auto_gain_beside_lamps, develop};

fn png(path: &Path) -> Picture {
    let image = image::open(path).unwrap().to_rgb8();
    let pixels = image.pixels().map(|p| p.0).collect();
    Picture { width: image.width() as usize, height: image.height() as usize, pixels }
}

/// Returns true if `part` stands somewhere in `whole`.
fn contains(whole: &Picture, part: &Picture) -> bool {
    let (w, h) = (part.width, part.height);
    if w > whole.width || h > whole.height {
        return false;
    }
    let first = part.pixels[0];
    let row = |x: usize, y: usize| &whole.pixels[y * whole.width + x..][..w];
    let at = |x: usize, y: usize| {
        whole.pixels[y * whole.width + x] == first && (0..h).all(|r| row(x, y + r) == &part.pixels[r * w..][..w])
    };
    (0..=whole.height - h).any(|y| (0..=whole.width - w).any(|x| at(x, y)))
}

/// Every gain that a picture may have: …, 1/2, 1/1.5, 1, 1.5, 2, ….
fn gains() -> impl Iterator<Item = f64> {
    (0..=8).map(|n| 2f64.powi(n)).flat_map(|power| [power, 1.5 * power, 1.0 / (1.5 * power), 0.5 / power])
}

/// The factor by which an image is enlarged on a sheet, if it is shown with this gain.
fn enlarged_by(sheet: &Picture, [w, h]: [usize; 2], pixels: &[[f32; 3]], gain: f64) -> Option<usize> {
    let small = develop(w, h, pixels, gain).picture;
    (1..=40).find(|&m| contains(sheet, &small.enlarged(m)))
}

/// The whole image that `series` renders with each value, and its term k = 0, from its EXR file.
fn images(line: &str, option: &str, values: &[&str]) -> Vec<[Vec<[f32; 3]>; 2]> {
    let desk = TempDir::new().unwrap();
    let one = |value: &&str| {
        let line = format!("series {line} --worlds terms {option} {value} -o {value}");
        let said = run(desk.path(), &line);
        assert_eq!(said.code, 0, "{line}: {}", said.err);
        let image = exr::read(&desk.path().join(value).join("terms.exr")).unwrap();
        ["Tall", "T00"].map(|layer| image.layer(layer).unwrap().to_vec())
    };
    values.iter().map(one).collect()
}

/// The panels are the images of `series`, enlarged by one whole factor to at least 256 pixels, all with the gain that suits the
/// quietest one outside the lamp.
#[test]
fn every_value_has_its_picture_at_one_exposure() {
    let line = "cornell --size 24x20 --spp 32 --max-bounces 3 -q --seed 2";
    let s = swept(&format!("{line} --over technique"));
    let values = s.values();
    assert_eq!(values, ["scatter", "connect", "mis", "mis-power"]);
    let sheet = png(&s.folder.join("pictures.png"));
    assert!(sheet.width <= 1920, "{}", sheet.width);
    let images = images(line, "--technique", &values);
    // the one gain with which the first image is found is the gain of all
    let found: Vec<f64> = gains().filter(|&g| enlarged_by(&sheet, [24, 20], &images[0][0], g).is_some()).collect();
    assert_eq!(found.len(), 1, "the first image is shown once: {found:?}");
    for (value, [pixels, _]) in values.iter().zip(&images) {
        let factor = enlarged_by(&sheet, [24, 20], pixels, found[0]);
        let factor = factor.unwrap_or_else(|| panic!("{value} is not shown with the gain {}", found[0]));
        assert!(24 * factor >= 256, "{value}: {} pixels", 24 * factor);
    }
    let summary = summary::read(&s.folder.join("summary.json")).unwrap();
    assert!(summary.files.contains(&"pictures.png".to_string()), "{:?}", summary.files);
    // scatter has by far the most noise, so that the exposure that suits it is another one
    let own = |i: usize| auto_gain_beside_lamps(&images[i][0], &images[i][1]);
    assert_ne!(own(0), found[0], "the test cannot tell a common gain from separate ones");
    assert_eq!(own(2), found[0], "the gain is that of a quiet image");
}

/// A sheet at another exposure, or with smaller panels, is not what the test above accepts.
#[test]
fn another_gain_or_size_is_noticed() {
    let pixels: Vec<[f32; 3]> = (0..64).map(|i| [0.01 * i as f32, 0.3, 0.1]).collect();
    let sheet = develop(8, 8, &pixels, 2.0).picture.enlarged(32);
    assert_eq!(enlarged_by(&sheet, [8, 8], &pixels, 2.0), Some(32));
    assert_eq!(enlarged_by(&sheet, [8, 8], &pixels, 3.0), None);
    assert_eq!(enlarged_by(&develop(8, 8, &pixels, 2.0).picture.enlarged(4), [8, 8], &pixels, 2.0), Some(4));
}

/// Equal time: the most expensive value has the samples of --spp, and the cheap one more. Each row has the bits of a render with
/// the number of samples that is printed.
#[test]
fn equal_time_gives_cheap_values_more_samples() {
    let line = "furnace --size 16x16 --max-bounces 3 -q";
    let s = swept(&format!("{line} --over branching --values 1,4 --equal-time --technique scatter --spp 16"));
    let spp = |value: &str| s.number(value, "all", "spp");
    // with the tail, about 150 rays per path against 5
    assert_eq!(spp("4"), 16.0);
    assert!(spp("1") > 3.0 * 16.0, "{}", spp("1"));
    let printed = |value: &str| {
        let words = |l: &str| l.split_whitespace().map(String::from).collect::<Vec<_>>();
        let of = |w: &Vec<String>| w.first().is_some_and(|f| f == value) && w.get(1) == Some(&spp(value).to_string());
        s.said.out.lines().map(words).any(|w| of(&w))
    };
    assert!(printed("1") && printed("4"), "{}", s.said.out);
    let said = s.said.out.replace('\n', " ");
    assert!(said.contains("Equal time") && said.contains("depend on this machine"), "{}", s.said.out);
    let same = swept(&format!("{line} --over branching --values 1 --technique scatter --spp {}", spp("1")));
    for k in ["0", "2", "all"] {
        assert_eq!(s.number("1", k, "mean_g"), same.number("1", k, "mean_g"), "{k}");
        assert_eq!(s.number("1", k, "rays"), same.number("1", k, "rays"), "{k}");
    }
}

#[test]
fn roulette_shows_the_schedules_that_it_renders() {
    let desk = TempDir::new().unwrap();
    let line = "roulette cornell --size 16x16 --spp 16 --max-bounces 4 -q";
    assert_eq!(run(desk.path(), &format!("{line} -o predicted")).code, 0);
    assert!(!desk.path().join("predicted/pictures.png").exists(), "nothing is rendered");
    let said = run(desk.path(), &format!("{line} --verify --schedules lecture,albedo,none -o verified"));
    assert!(said.code <= 1, "{}", said.err);
    let summary = summary::read(&desk.path().join("verified/summary.json")).unwrap();
    assert!(summary.files.contains(&"pictures.png".to_string()), "{:?}", summary.files);
    let sheet = png(&desk.path().join("verified/pictures.png"));
    assert!((3 * 256..=1920).contains(&sheet.width), "{}", sheet.width);
    // one thread makes the same pictures
    let line = format!("{line} --verify --schedules lecture,albedo,none -o verified -t 1");
    assert!(run(desk.path(), &line).code <= 1);
    assert_eq!(png(&desk.path().join("verified/pictures.png")), sheet);
}

/// The ends of all lines of a plot in CSS pixels, with their colour.
fn lines(svg: &str) -> Vec<([f64; 4], String)> {
    let attribute = |e: &str, name: &str| Some(e.split_once(&format!(" {name}=\""))?.1.split_once('"')?.0.to_string());
    let line = |e: &str| {
        let points = attribute(e, "points").filter(|_| e.starts_with("polyline"))?;
        let ends: Vec<f64> = points.split([' ', ',']).filter_map(|x| x.parse::<f64>().ok()).map(|x| x / 10.0).collect();
        Some((<[f64; 4]>::try_from(ends).ok()?, attribute(e, "stroke")?))
    };
    svg.split('<').filter_map(line).collect()
}

/// In the panels of the schedules, which have no order, no line leads from one schedule to another: every line is horizontal or
/// vertical, and vertical ones belong to frame and grid. The panel of q against the vertex below has joining lines.
#[test]
fn schedules_are_not_joined() {
    let desk = TempDir::new().unwrap();
    let line =
        "roulette cornell --size 8x8 --spp 16 --max-bounces 4 -q --verify --schedules lecture,none,constant:0.3@2 -o r";
    assert!(run(desk.path(), line).code <= 1);
    let all = lines(&std::fs::read_to_string(desk.path().join("r/roulette.svg")).unwrap());
    // the upper panels: from 96 pixels on, 26 pixels for each schedule
    let (above, below): (Vec<_>, Vec<_>) =
        all.into_iter().partition(|([_, y0, _, y1], _)| y0.max(*y1) < 96.0 + 3.0 * 26.0 + 5.0);
    let grey = |color: &str| color[1..3] == color[3..5] && color[3..5] == color[5..7];
    let data = above.iter().filter(|l| !grey(&l.1) || l.1 == "#000000").collect::<Vec<_>>();
    assert!(data.len() >= 9, "three panels with three schedules: {}", data.len());
    assert!(data.iter().all(|([_, y0, _, y1], _)| (y0 - y1).abs() < 1e-9), "{data:?}");
    let slanted = |l: &&([f64; 4], String)| (l.0[0] - l.0[2]).abs() > 1.0 && (l.0[1] - l.0[3]).abs() > 1.0;
    assert!(below.iter().any(|l| slanted(&l)), "the test sees the lines of a curve");
}

/// A sweep joins the terms of one value, which have an order: each line leads at least one bounce to the right. A line between
/// values at the same k would be shorter than a quarter of that.
#[test]
fn values_of_a_sweep_are_not_joined() {
    let s = swept(&format!("cornell --over technique {SMALL}"));
    let all = lines(&std::fs::read_to_string(s.folder.join("sweep.svg")).unwrap());
    let slanted: Vec<_> = all.iter().filter(|(l, _)| (l[0] - l[2]).abs() > 1.0 && (l[1] - l[3]).abs() > 1.0).collect();
    assert!(slanted.len() >= 12, "two panels, four values, some terms: {}", slanted.len());
    // K = 3: panels of 372 pixels hold four bounces
    let least = slanted.iter().map(|(l, _)| l[2] - l[0]).fold(f64::INFINITY, f64::min);
    assert!(least > 0.9 * 372.0 / 4.0, "a line of {least} pixels joins values");
    let mut colours: Vec<&str> = slanted.iter().map(|l| l.1.as_str()).collect();
    colours.sort_unstable();
    colours.dedup();
    assert_eq!(colours.len(), 4, "each value has its own lines");
}
