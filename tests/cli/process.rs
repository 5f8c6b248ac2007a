//! The program as a process: exit codes, folders of other runs, Ctrl-C, closed pipes, and the help.

use super::*;

#[test]
fn another_runs_output_is_never_touched() {
    let desk = Desk::new();
    let line = |spp: u32| format!("series cornell --worlds terms --spp {spp} --size 8x8 -q");
    let out = desk.path("fredholm-out");
    let folders = || {
        let mut all: Vec<_> = std::fs::read_dir(&out).unwrap().map(|f| f.unwrap().file_name()).collect();
        all.sort();
        all
    };
    desk.ok(&line(4));
    let first = contents(&out.join("cornell-series"));
    // the same command, also when typed with what does not matter, replaces its own
    desk.ok(&format!("{} -vt 1 --json", line(4)));
    assert_eq!(folders(), ["cornell-series"]);
    assert_eq!(contents(&out.join("cornell-series"))["terms.exr"], first["terms.exr"]);
    // another command goes next to it, and finds its own place again
    let first = contents(&out.join("cornell-series"));
    for _ in 0..2 {
        desk.ok(&line(5));
        assert_eq!(folders(), ["cornell-series", "cornell-series-2"]);
        assert!(contents(&out.join("cornell-series")) == first, "nothing in the first folder changed");
    }
    // -o with another run's content is refused
    let said = desk.run(&format!("{} -o fredholm-out/cornell-series", line(6)));
    assert_eq!(said.code, 3);
    insta::assert_snapshot!(said.err, @r"
    error: the output folder holds another run's output
      --> fredholm-out/cornell-series
    help: choose another with -o, or replace it with --force
    ");
    assert!(contents(&out.join("cornell-series")) == first, "nothing in the refused folder changed");
    // --force replaces it, and leaves nothing of the old run and everything of anybody else's
    std::fs::write(out.join("cornell-series/notes.txt"), "mine").unwrap();
    desk.ok("render cornell --spp 4 --size 8x8 -q -o fredholm-out/cornell-series --force");
    let mut now = desk.summary("fredholm-out/cornell-series").files;
    assert!(!now.contains(&"T00.png".into()));
    now.push("notes.txt".into());
    now.sort();
    assert_eq!(names(&out.join("cornell-series")), now);
}

#[test]
fn commands_end_as_they_say() {
    let desk = Desk::new();
    let said = desk.ok("info");
    insta::assert_snapshot!(said.out, @r#"
    14 scenes are built in; a command takes one of these names, or the path of a
    .toml or .obj file.
    `fredholm info NAME` describes a scene.

    cornell         a Cornell box with two blocks: colour bleeding between the walls
    furnace         closed; every surface emits 1 and has albedo 0.5: T^k E = 0.5^k
    sphere          an integrating sphere lit by its cap: terms k ≥ 1 are constant
    shells          two concentric spheres: exact terms of a 2 by 2 operator
    cornell-spheres a Cornell box with a mirror and a glass sphere: caustics
    veach-mis       glossy plates, lamps of equal power and different size: MIS
    veach-ajar      a room lit through a slightly open door: a long series
    env-ggx         gold, copper and plastic under a sky and a point light: GGX
    caustic         a glass sphere focuses a small lamp: hard to find from the eye
    glass-furnace   a glass ball in a sky of radiance 1: every pixel sums to 1
    mirror-corridor two parallel mirrors of reflectance 0.9: T^k E decays slowly
    sky-bowl        part of a sphere open to a sky of radiance 1: constant terms
    many-lights     96 lamps from 0.01 to 10 W: light selection by power or uniform
    cube            a closed cube with an emitting ceiling: L and r(T) are known
    "#);
    let said = desk.ok("info furnace");
    insta::assert_snapshot!(said.out, @r#"
    furnace: 6 primitives, 1 light, diffuse surfaces, 64×64 pixels; ‖T‖₁ ≤ 0.5000,
    so 7 bounces are enough: all longer paths together are below 1 % of ‖E‖₁.
    This is the guaranteed bound; usually far fewer bounces are enough.
    `fredholm series furnace` measures how fast the terms decay.

    The materials, and the sides of a surface that they are on.
      wall             diffuse, reflectance (0.500, 0.500, 0.500), front only

    The lights: shape, area, radiance in W sr⁻¹ m⁻² (red, green, blue), power in W.
      shapes[0]        box          24.00 m²   1.000                    75.40

    The operator T, before anything is rendered.
      surfaces that reflect or emit: 24.0000 m²
      ‖T‖ ≤ largest albedo = 0.5000, in every Lp norm of the throughput measure
      guaranteed: ‖L − S_K‖₁ ≤ 0.5000^(K+1)/0.5000 · ‖E‖₁

    Expected image means of the terms, k = 0 to 8, from theory.
      1.0000, 0.50000, 0.25000, 0.12500, 0.062500, 0.031250, 0.015625, 0.0078125,
      0.0039062
      source: T 1 = rho 1 in a closed scene of uniform albedo, so T^k E = rho^k E
    "#);
    let said = desk.ok("info cornell --json");
    assert_eq!(serde_json::from_str::<serde_json::Value>(&said.out).unwrap()["name"], "cornell");
    let furnace = fredholm::scene::builtin::find("furnace").unwrap().source;
    std::fs::write(desk.path("bad.toml"), format!("bogus = 1\n{furnace}")).unwrap();
    for line in ["info bad.toml", "series bad.toml", "render bad.toml"] {
        let said = desk.run(line);
        assert_eq!((said.code, said.out.as_str()), (3, ""), "{line}");
        assert!(said.err.starts_with("error: ") && said.err.contains("--> bad.toml:1"), "{}", said.err);
    }
    let said = desk.ok("render cornell --spp 8 --size 8x8 -q -v");
    assert!(said.out.contains("roulette: path tracer lecture (q ends a path"), "{}", said.out);
    assert!(row(&said.out, "all").len() == 1 && row(&said.out, "Σ").is_empty(), "{}", said.out);
    let said = desk.ok("radiosity cornell --spp 8 --size 8x8 --patches 60 -q -v");
    assert!(said.out.contains("spectral radius (0."), "{}", said.out);
    assert!(!said.out.contains("roulette"), "no walk, no roulette: {}", said.out);
    let said = desk.ok("chapter");
    assert!(said.out.starts_with(" 1  "), "{}", said.out);
    assert_eq!(desk.run("chapter 99").code, 2);
}

#[test]
fn a_second_ctrl_c_is_not_needed() {
    let desk = Desk::new();
    let line = format!("series cornell --spp 10000000 {SMALL} -o long");
    let mut child = desk.command(&line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let started = Instant::now();
    while !desk.path("long/terms.png").exists() {
        assert!(started.elapsed() < Duration::from_secs(20), "no preview");
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let (out, err) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert!(err.contains("interrupted: saving what exists") && !err.contains("panicked"), "{err}");
    let s = desk.summary("long");
    assert!((16..10_000_000).contains(&s.spp), "{}", s.spp);
    assert!(out.contains(&format!("{} of 10000000 spp", s.spp)), "{out}");
    let image = desk.image("long");
    for name in ["", "T00", "T03_se", "tail", "Tall_se"] {
        let finite = image.layer(name).unwrap().iter().flatten().all(|v| v.is_finite());
        assert!(finite, "{name}");
    }
    assert!(s.terms.iter().all(|t| t.mean.is_finite() && t.std_error.is_finite()));
    // and the state, from which it can go on
    let mut listed = s.files;
    listed.push("state.fsh".into());
    listed.sort();
    assert_eq!(names(&desk.path("long")), listed, "no temporary file is left");
}

#[test]
fn a_closed_pipe_is_no_crash() {
    let desk = Desk::new();
    let line = "series furnace --spp 4 --size 4x4 --json -q";
    let mut child = desk.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_ne!(output.status.code(), Some(101));
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}

#[test]
fn help_says_how_k_counts() {
    let desk = Desk::new();
    let said = desk.ok("series --help");
    assert!(said.out.contains("k = 0 is emission seen directly"), "{}", said.out);
    assert!(said.out.contains("max_depth = K + 1") && said.out.contains("TERMINATION"), "{}", said.out);
    insta::assert_snapshot!(desk.ok("--help").out, @r#"
    The operator view of global illumination: L = E + T L = Σ T^k E, measured

    Without arguments: the tour. A Cornell box is solved in three ways (each bounce by its own
    estimator, the full path tracer, the radiosity matrix). The answers are compared with error bars and
    written to fredholm-out/cornell with pictures, plots and a report.

    Usage: fredholm [SCENE]
           fredholm <COMMAND>

    Commands:
      tour         Solves one scene in three ways and compares them (the default)
      series       Estimates each T^k E and the sum; compares path tracer and matrix
      render       Renders with the path tracer alone
      radiosity    Solves with the matrix alone: form factors, solvers, modes
      merge        Puts the parts of a run together: the bits of one run
      slurm        Prints a script that renders on a Slurm cluster
      compare      Compares two results: a verdict per term, a map of z
      diagnose     Checks another renderer's pictures, and names the mistake
      sweep        Varies one setting: cost and variance of the terms
      walk         Runs the estimators on the radiosity matrix, where T^k E is known
      check        Tests if an estimator is biased, or if L = E + T L holds
      figure       Makes a figure: data, pictures, and the command that makes them
      roulette     Predicts, verifies and optimises Russian roulette
      zoo          Shows estimators that are wrong on purpose
      info         Lists scenes, or describes one: materials, lights, bounds on ‖T‖
      export       Writes a scene for Mitsuba 3 or pbrt-v4
      chapter      Runs a chapter of the book
      exercise     Asks an exercise with your own numbers, and judges the answer
      book         Opens the book in the browser
      completions  Prints a script that completes commands in a shell
      man          Prints the man page, or writes one for every command
      help         Print this message or the help of the given subcommand(s)

    Options:
      -h, --help
              Print help (see a summary with '-h')

      -V, --version
              Print version

    Examples:
      fredholm                                   the tour
      fredholm series cornell --spp 64           each bounce, and their sum
      fredholm series box.toml --set materials.white.reflectance=[0.6,0.6,0.6]
      fredholm compare fredholm-out/cornell b    a verdict per term
      fredholm sweep cornell --over technique    one setting, several values
      fredholm roulette cornell --optimise       how paths should end
      fredholm info                              the built-in scenes
      fredholm info cornell                      materials, lights, bounds

    Options of a command: fredholm COMMAND -h for the usual ones, fredholm COMMAND --help for all.

    Exit codes: 0 ok, 1 a comparison failed, 2 wrong usage, 3 something is wrong with a scene or a file,
    130 interrupted; 143 and 129 ended by SIGTERM and SIGHUP (results so far are saved).
    "#);
}
