//! Tables are aligned, and the page needs no other file.

use super::*;

#[test]
fn tables_are_aligned_and_narrow() {
    let series = &full_summary().series[0];
    let rays = [123_456_789_012, 5, 999_999];
    let text = table::series("terms", series.image(), &rays);
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines.len(), 1 + 2 + 3 + 3, "{text}");
    let verdict = VerdictRecord {
        name: "a very long name of a comparison, longer than any".into(),
        ..full_summary().verdicts[0].clone()
    };
    let verdicts = table::verdicts(&[verdict]);
    for line in text.lines().chain(verdicts.lines()) {
        assert!(line.chars().count() <= 100, "{line}");
    }
    // Numbers of a column end in the same place.
    let ends = |row: &str| row.chars().count();
    assert!(lines[3..6].iter().all(|row| ends(row) == ends(lines[3])), "{text}");
    // Average of (v, v/3, v/7); the interval is that of 15 degrees of freedom.
    let mean = (1.0 + 1.0 / 3.0 + 1.0 / 7.0) / 3.0;
    assert!(lines[3].contains(&table::significant(mean, 4)), "{text}");
    assert!(lines[3].contains(&table::significant(2.131_449_5 * 0.01, 2)), "{text}");
    assert!(lines[6].contains('–'), "an unknown error is a dash: {text}");
}

#[test]
fn page_is_self_contained_and_escapes() {
    let folder = tempfile::tempdir().unwrap();
    let (png, svg) = (folder.path().join("terms.png"), folder.path().join("decay.svg"));
    contact_sheet::single("T0", 20, 20, &ramp(20, 20, 1.0), None).unwrap().0.picture.write(&png).unwrap();
    let points = (0..4).map(|k| Point::exact(f64::from(k), 0.5f64.powi(k))).collect();
    let decay = Decay { surface: vec![curve(points)], ..Decay::default() };
    decay::draw(&decay, &caption()).unwrap().write(folder.path(), "decay").unwrap();
    let summary = full_summary();
    let mut grid = Grid::new("a <p> b", ["<q>", "x"]);
    grid.push(["<s>".into(), "1".into()]);
    let page = html::Page {
        data: None,
        title: "<script>alert(1)</script>".into(),
        command: "fredholm series 'a&b.toml' --set x=\"<b>\"".into(),
        facts: vec![("se<ed".into(), "1 > 0".into())],
        answer: "a < b".into(),
        comparisons: vec![("<u>".into(), summary.verdicts.clone())],
        grids: vec![grid],
        plates: vec![Plate::terms(&png), Plate::decay(&svg)],
        series: vec![("<i>".into(), summary.series[0].image())],
        files: vec![("a \"b\".exr".into(), "all <terms>".into()), ("javascript:x".into(), String::new())],
    };
    let path = folder.path().join("index.html");
    html::write(&path, &page).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();

    assert!(!text.contains("http"), "the page refers to the network");
    for raw in [
        "<script",
        "<b>\"",
        "<i>",
        "<u>",
        "<p> b",
        "<q>",
        "<s>",
        "a < b",
        "se<ed",
        "<terms>",
        "a \"b\"",
        "href=\"javascript",
    ] {
        assert!(!text.contains(raw), "{raw} is not escaped");
    }
    assert!(text.contains("&lt;script&gt;") && text.contains("href=\"./a%20%22b%22.exr\""));
    assert!(text.contains("data:image/png;base64,iVBOR") && text.contains("<svg role=\"img\""));
    // Every element that is opened is closed.
    for tag in
        ["section", "details", "summary", "table", "tbody", "tr", "td", "figure", "svg", "main", "header", "dl", "ul"]
    {
        let opened = text.matches(&format!("<{tag}>")).count() + text.matches(&format!("<{tag} ")).count();
        assert_eq!(opened, text.matches(&format!("</{tag}>")).count(), "<{tag}>");
    }
    // Every table behind a comparison or a series is folded.
    assert_eq!(text.matches("<table class=\"stack\">").count() + 1, text.matches("<details>").count());
    let missing = Plate::terms(Path::new("absent.png"));
    assert!(html::render(&html::Page { plates: vec![missing], ..html::Page::default() }).is_err());
}

/// With data, the images come first; what scripts need is in the page, and still plots are marked as such.
#[test]
fn page_with_data_holds_its_scripts_and_images() {
    let folder = tempfile::tempdir().unwrap();
    let points = (0..4).map(|k| Point::exact(f64::from(k), 0.5f64.powi(k))).collect();
    let decay = Decay { surface: vec![curve(points)], ..Decay::default() };
    decay::draw(&decay, &caption()).unwrap().write(folder.path(), "decay").unwrap();
    let mut data = Data::new([4, 2]);
    data.command = "fredholm series 'a&b.toml' --set x=\"<b>\"".into();
    let trust = PixelErrors { layer: "path".into(), trusted: false, events: 2.0, why: "not trusted".into() };
    let pixels = [[0.5f32; 3]; 8];
    data.push(&[Image {
        id: "path".into(),
        world: World::Path,
        slot: Slot::Whole,
        spp: 16,
        mean: Some(&pixels),
        std_error: &pixels,
        trust,
        apart: true,
    }]);
    let svg = folder.path().join("decay.svg");
    let page = html::Page {
        data: Some(&data),
        comparisons: vec![("they agree".into(), full_summary().verdicts.clone())],
        plates: vec![Plate::decay(&svg)],
        ..html::Page::default()
    };
    let text = html::render(&page).unwrap();
    assert!(!text.contains("http"), "the page refers to the network");
    let place = |what: &str| text.find(what).unwrap_or_else(|| panic!("{what} is missing"));
    assert!(place("id=\"canvas\"") < place("Do the answers agree?"));
    assert!(place("id=\"px-path\"") < place("data-module=\"#page/main.js\""));
    assert!(text.contains("<figure data-still><svg") && text.contains("id=\"plot-decay\""));
    assert!(text.contains("x=&quot;&lt;b&gt;&quot;") && !text.contains("x=\"<b>"), "the command is not escaped");
    // every element that is opened is closed, before the sources of the scripts begin
    let markup = &text[..place("<script id=\"run\"")];
    for tag in ["section", "div", "button", "p", "label", "canvas", "dialog", "fieldset", "select", "form"] {
        let opened = markup.matches(&format!("<{tag}>")).count() + markup.matches(&format!("<{tag} ")).count();
        assert!(opened > 0, "no <{tag}>");
        assert_eq!(opened, markup.matches(&format!("</{tag}>")).count(), "<{tag}>");
    }
}
