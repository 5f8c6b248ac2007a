//! Folders under stress: two runs at once, killed runs, signals, and outputs that would replace inputs.

use super::*;
use std::process::Child;

/// Starts a long run and waits for its first preview.
fn at_work(desk: &Desk, line: &str, folder: &str) -> Child {
    let mut child = desk.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let started = Instant::now();
    while !desk.path(folder).join("terms.png").exists() {
        assert!(started.elapsed() < Duration::from_secs(20), "no preview");
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        std::thread::sleep(Duration::from_millis(10));
    }
    child
}

fn send(signal: &str, child: &Child) {
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
}

fn hidden(desk: &Desk, folder: &str) -> Vec<String> {
    let all = std::fs::read_dir(desk.path(folder)).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap());
    all.filter(|name| name.starts_with('.')).collect()
}

#[test]
fn a_folder_has_one_run_at_a_time() {
    let desk = Desk::new();
    let long = format!("series cornell --worlds terms --spp 10000000 {SMALL}");
    let child = at_work(&desk, &format!("{long} -o long"), "long");
    let said = desk.run(&format!("{long} -o long"));
    assert_eq!(said.code, 3, "{}", said.err);
    assert!(said.err.contains("another run is writing") && said.err.contains("help: "), "{}", said.err);
    let said = desk.run("render cornell --spp 1 --size 8x8 -q -o long --force");
    assert_eq!(said.code, 3, "--force does not break a run: {}", said.err);
    send("-INT", &child);
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(130));
    assert_eq!(hidden(&desk, "long"), Vec::<String>::new());
    // without -o, the second run takes the next name
    let child = at_work(&desk, &long, "fredholm-out/cornell-series");
    let mut second = desk.command(&long).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let started = Instant::now();
    while !desk.path("fredholm-out/cornell-series-2/terms.png").exists() {
        assert!(started.elapsed() < Duration::from_secs(20), "no second folder");
        std::thread::sleep(Duration::from_millis(10));
    }
    send("-INT", &child);
    send("-INT", &second);
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(130));
    assert_eq!(second.wait().unwrap().code(), Some(130));
}

#[test]
fn a_killed_run_leaves_its_folder_to_the_same_command() {
    let desk = Desk::new();
    let long = format!("series cornell --worlds terms --spp 10000000 {SMALL} -o long");
    let mut child = at_work(&desk, &long, "long");
    child.kill().unwrap();
    child.wait().unwrap();
    let other = desk.run("series cornell --worlds terms --spp 4 --size 8x8 -q -o long");
    assert_eq!(other.code, 3, "{}", other.err);
    std::fs::write(desk.path("long/.terms.exr.1.tmp"), "half").unwrap();
    std::fs::remove_file(desk.path("long/terms.png")).unwrap();
    let child = at_work(&desk, &long, "long");
    send("-INT", &child);
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(130));
    assert_eq!(hidden(&desk, "long"), Vec::<String>::new());
    assert!(desk.summary("long").spp >= 16);
}

#[test]
fn every_signal_saves_and_has_its_exit_code() {
    // under nohup, SIGHUP is ignored here and in what is started from here
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|l| l.strip_prefix("SigIgn:"))
        .map_or(0, |m| u64::from_str_radix(m.trim(), 16).unwrap());
    for (signal, code) in [("-TERM", 143), ("-HUP", 129)] {
        if signal == "-HUP" && mask & 1 == 1 {
            continue;
        }
        let desk = Desk::new();
        let long = format!("series cornell --worlds terms --spp 10000000 {SMALL} -o long");
        let child = at_work(&desk, &long, "long");
        send(signal, &child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(code));
        assert!(String::from_utf8_lossy(&output.stderr).contains("interrupted: saving what exists"));
        assert!(desk.summary("long").spp >= 16);
    }
}

#[test]
fn a_second_signal_ends_at_once_and_leaves_nothing_half_written() {
    let desk = Desk::new();
    let long = format!("series cornell --spp 10000000 {SMALL} -o long");
    let child = at_work(&desk, &long, "long");
    send("-TERM", &child);
    send("-TERM", &child);
    send("-INT", &child);
    let code = child.wait_with_output().unwrap().status.code();
    // 143: ended at once by SIGTERM, or saved in time; 130: ended at once by SIGINT
    assert!(code == Some(143) || code == Some(130), "{code:?}");
    let left = hidden(&desk, "long");
    assert!(left.iter().all(|name| name == ".fredholm.run"), "{left:?}");
}

#[test]
fn an_input_is_never_an_output() {
    let desk = Desk::new();
    for (folder, seed) in [("a", 1), ("b", 2)] {
        desk.ok(&format!("series cornell --worlds terms --spp 16 --size 8x8 --seed {seed} -q -o {folder}"));
    }
    let before = contents(&desk.path("a"));
    for line in [
        "compare a b -o a --force",
        "compare b a/summary.json -o a --force",
        "compare a b -o ./b/../a --force",
        "diagnose a/terms.exr --against b -o a --force",
        "diagnose b/terms.exr --against a -o a --force",
    ] {
        let said = desk.run(line);
        assert_eq!(said.code, 3, "{line}: {}", said.err);
        assert!(said.err.contains("holds an input"), "{line}: {}", said.err);
        assert!(contents(&desk.path("a")) == before, "{line} changed its input");
    }
    // beside its inputs is a fine place
    let said = desk.run("compare a b -o c");
    assert!([0, 1].contains(&said.code), "{}", said.err);
}

/// A terminal obeys escape sequences, and a name that changes the direction of writing looks like another one.
#[test]
fn names_do_not_reach_the_terminal_as_commands() {
    let desk = Desk::new();
    let furnace = fredholm::scene::builtin::find("furnace").unwrap().source;
    let wrong = ["re\u{1b}[31md", "a\u{202e}gnp", "b\u{7}"];
    for name in wrong {
        let file = format!("{name}.toml");
        std::fs::write(desk.path(&file), furnace.replacen("name", "nmae", 1)).unwrap();
        let said = desk.command("info").arg(&file).output().unwrap();
        let text = String::from_utf8_lossy(&said.stdout).into_owned() + &String::from_utf8_lossy(&said.stderr);
        assert_eq!(said.status.code(), Some(3), "{text}");
        let hidden = |c: char| c != '\n' && (c.is_control() || c == '\u{202e}');
        assert!(!text.contains(hidden), "{text:?}");
        let said = desk.command("series").args(["--set", name]).arg("cornell").output().unwrap();
        let text = String::from_utf8_lossy(&said.stderr).into_owned();
        assert!(!said.status.success() && !text.contains(hidden), "{text:?}");
    }
    let long = "x".repeat(230);
    std::fs::write(desk.path(&format!("{long}.toml")), furnace.replacen("name", "# name", 1)).unwrap();
    let said = desk.run(&format!("series {long}.toml --spp 1 --size 4x4"));
    assert_eq!(said.code, 3);
    assert!(said.err.contains("200 are possible"), "{}", said.err);
}
