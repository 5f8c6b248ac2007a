//! The walk of the zoo path by path: without a mistake it is the prefix estimator, and blind scenes show no mistake.

use super::*;

/// Independent code, equal samples: every term of every path, and the rays it took.
#[test]
fn without_a_mistake_the_walk_is_the_prefix_estimator_path_by_path() {
    let others = ["env-ggx", "veach-ajar"].map(|scene| Stage { label: scene, scene, set: &[] });
    let mut compared = 0;
    for stage in stages().into_iter().chain(others) {
        let scene = Scene::new(&stage.load([8, 8]).unwrap());
        for sampling in [Sampling::Bsdf, Sampling::Uniform] {
            let t = SceneTransport { scene: &scene, sampling };
            for technique in Technique::ALL {
                for roulette in [Roulette::Never, Roulette::LECTURE, Roulette::Albedo { from: 1 }] {
                    let plan = Plan { max_bounces: 4, technique, roulette };
                    let prefix = samples(&t, &scene.camera, &Prefix(plan.clone()));
                    let walk = samples(&t, &scene.camera, &Walk { plan: plan.clone(), mistake: &Right });
                    let what = format!("{} {sampling:?} {plan:?}", stage.label);
                    assert_eq!(prefix.rays, walk.rays, "{what}");
                    compared += same(&prefix, &walk).unwrap_or_else(|why| panic!("{what}: {why}"));
                }
            }
        }
    }
    assert!(compared > 50_000, "{compared}");
}

/// A scene that is blind to a mistake shows the same path by path: no statistics needed.
#[test]
fn blind_scenes_are_blind_path_by_path() {
    for bug in zoo::all() {
        let settings = Settings { max_bounces: K, ..Settings::default() };
        let plan = bug.plan(&settings);
        let stage = bug.blind.unwrap_or(Stage::CORNELL);
        let scene = Scene::new(&stage.load([8, 8]).unwrap());
        let t = SceneTransport::new(&scene);
        let walk = |mistake| Walk { plan: plan.clone(), mistake };
        let right = walk(&Right);
        let whole = |w| samples(&t, &scene.camera, &Whole(w));
        let of = |w: Walk| samples(&t, &scene.camera, &w);
        let mut seen =
            same(&whole(walk(&Right)), &whole(walk(bug.mistake))).unwrap_or_else(|e| panic!("{}: {e}", bug.name));
        let terms = same(&of(right), &of(walk(bug.mistake)));
        match bug.blind {
            Some(_) => seen += terms.unwrap_or_else(|e| panic!("{}: {e}", bug.name)),
            None => assert!(terms.is_err(), "{}", bug.name),
        }
        assert!(seen > 100, "{} is shown a dark {}: {seen}", bug.name, stage.label);
    }
}

/// Names can be typed, and every member says what it must.
#[test]
fn members_introduce_themselves() {
    let all = zoo::all();
    assert!(all.len() >= 30, "{}", all.len());
    for (i, bug) in all.iter().enumerate() {
        assert!(bug.name.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{}", bug.name);
        assert!(all[..i].iter().all(|b| b.name != bug.name), "{} twice", bug.name);
        for text in [bug.what, bug.place, bug.expected, bug.signature] {
            assert!(!text.is_empty() && !text.ends_with('.'), "{}: {text}", bug.name);
        }
        assert_ne!(Some(bug.exposed_by), bug.blind, "{}", bug.name);
        assert!(std::ptr::eq(zoo::find(bug.name).unwrap(), *bug));
    }
}

/// Uniform or by power: only a mistake in the choice depends on it.
#[test]
fn the_walk_follows_the_selection_of_lights() {
    let d = Stage::MANY_LIGHTS.load([4, 4]).unwrap();
    let scene = Scene::new(&d).select_lights(Selection::Power);
    let t = SceneTransport::new(&scene);
    let plan = Plan { max_bounces: 2, technique: Technique::Mis, roulette: Roulette::Never };
    let prefix = samples(&t, &scene.camera, &Prefix(plan.clone()));
    assert!(same(&prefix, &samples(&t, &scene.camera, &Walk { plan, mistake: &Right })).unwrap() > 40);
}
