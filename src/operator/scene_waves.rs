//! T sampled for a wave of paths in a scene: the same steps as for one path, each done for all paths before the next.
//!
//! ```text
//! connect   sort by surface → light points → f cos θ/p → shadow rays            → weight · E where nothing blocks
//! scatter   sort by surface → directions and weights → rays → first surfaces    → new states with both densities
//! ```
//!
//! | step | place |
//! |---|---|
//! | sort by surface; BSDFs in SIMD lanes | [`crate::scene::groups`](crate::scene) |
//! | light points | `Scene::light_wave` |
//! | rays and shadow rays | `Scene::look_wave`, `Scene::block_wave` |
//!
//! Every number has the bits that [`SceneTransport`] computes for one path (tested).

use super::scene_transport::SceneTransport;
use super::transport::Samples;
use crate::math::{Columns, Rgb, Streams, pick};
use crate::scene::bsdf::{Bsdf, TransportMode};
use crate::scene::{
    Camera, DELTA, ESCAPED, LIGHT, NOTHING, NOWHERE, Rays, Received, VertexWave, Vertices, by_path, camera_rays,
    numbers,
};

impl SceneTransport<'_> {
    /// E at the first `n` vertices of a wave.
    pub(super) fn emission_of_wave(&self, wave: &VertexWave, n: usize, value: &mut Columns) {
        let VertexWave { p, n: normals, omega, side, .. } = wave;
        self.scene.light_of_wave(Vertices { p, n: normals, omega, side }, n, value);
    }

    /// One connection for each path of a wave.
    pub(super) fn connect_by_wave(&self, wave: &mut VertexWave, streams: Streams, out: &mut Samples) {
        numbers(streams, &mut wave.rays.u);
        self.connect_numbered(wave, streams.len(), out);
    }

    /// One connection for each of the first `n` paths, from the random numbers in `wave.rays.u`.
    pub(crate) fn connect_numbered(&self, wave: &mut VertexWave, n: usize, out: &mut Samples) {
        let VertexWave { p, n: normals, omega, side, rays } = wave;
        let at = Vertices { p, n: normals, omega, side };
        let lit = !self.scene.lights.is_empty();
        let places = if lit { self.scene.sort(at, n, rays, Bsdf::connects) } else { 0 };
        // paths without a place receive nothing
        if places < n {
            out.value.fill(n, Rgb::ZERO);
            out.pdf[..n].fill(1.0);
            out.other_pdf[..n].fill(0.0);
        }
        if !lit {
            return;
        }
        self.scene.light_wave(at, rays, places);
        self.scene.connect(at, rays, self.sampling);
        let some = pick::list_other(&mut rays.list, &rays.flag[..places], NOTHING);
        self.scene.block_wave(rays, some);
        by_path(rays, Received { value: &mut out.value, pdf: &mut out.pdf, other: &mut out.other_pdf });
    }

    /// One step of each path of a wave.
    pub(super) fn scatter_by_wave(
        &self,
        wave: &mut VertexWave,
        streams: Streams,
        out: &mut Samples,
        alive: &mut Vec<u32>,
    ) {
        numbers(streams, &mut wave.rays.u);
        self.scatter_numbered(wave, streams.len(), out, alive);
    }

    /// One step of each of the first `n` paths, from the random numbers in `wave.rays.u`.
    pub(crate) fn scatter_numbered(&self, wave: &mut VertexWave, n: usize, out: &mut Samples, alive: &mut Vec<u32>) {
        let VertexWave { p, n: normals, omega, side, rays } = wave;
        let at = Vertices { p, n: normals, omega, side };
        let on = self.depart_and_look(at, n, rays, TransportMode::Radiance);
        let list = &rays.list[..on];
        alive.extend(list.iter().map(|&place| rays.order[place as usize]));
        out.value.gather(&rays.value, list);
        pick::gather(&mut out.pdf, &rays.cosine, list);
        out.other_pdf[..on].fill(0.0);
        for (to, &place) in list.iter().enumerate() {
            let (seen, place) = (rays.side[place as usize], place as usize);
            // few rays find a light
            if seen < LIGHT && self.scene.light_density(seen) == 0.0 || rays.flag[place] == DELTA {
                continue;
            }
            if seen == ESCAPED {
                out.other_pdf[to] = self.scene.sky_pdf(rays.d.get(place));
            } else {
                let from = at.get(rays.order[place] as usize);
                (out.pdf[to], out.other_pdf[to]) = self.densities(&from, &rays.seen(place), rays.cosine[place]);
            }
        }
        take(wave, on);
    }

    /// Samples a direction at each of the first `n` vertices from the random numbers in `rays.u`, and traces the rays. Returns
    /// the number of paths that go on, and lists their places in `rays.list`, in ascending order of the paths. At these places
    /// are weights in `rays.value`, densities in `rays.cosine`, and what `Rays::seen` returns.
    pub(super) fn depart_and_look(&self, at: Vertices, n: usize, rays: &mut Rays, mode: TransportMode) -> usize {
        let places = self.scene.sort(at, n, rays, |_| true);
        self.scene.depart(at, rays, self.sampling, mode);
        let rest = rays.keep_samples(places);
        std::mem::swap(&mut rays.t, &mut rays.cosine);
        self.scene.look_wave(rays, rest);
        if rays.groups() <= 1 {
            return pick::list_other(&mut rays.list, &rays.side[..rest], NOWHERE);
        }
        rays.place[..n].fill(u32::MAX);
        for place in 0..rest {
            rays.place[rays.order[place] as usize] = place as u32;
        }
        let mut on = 0;
        for &place in rays.place[..n].iter().filter(|&&place| place != u32::MAX) {
            rays.list[on] = place;
            on += usize::from(rays.side[place as usize] != NOWHERE);
        }
        on
    }

    /// What the camera sees along one ray for each path of a wave.
    pub(super) fn start_by_wave(&self, camera: &Camera, wave: &mut VertexWave, streams: Streams, alive: &mut Vec<u32>) {
        numbers(streams, &mut wave.rays.u);
        let rays = &mut wave.rays;
        // the new paths may be those of another scene
        rays.sorted.clear();
        camera_rays(camera, streams.pixel, rays);
        self.scene.look_wave(rays, streams.len());
        let seen = pick::list_other(&mut rays.list, &rays.side[..streams.len()], NOWHERE);
        alive.extend_from_slice(&rays.list[..seen]);
        take(wave, seen);
    }
}

/// Moves the paths to what their rays see: path i to ray `list[i]` of the first `n` entries of the list. The directions of the
/// rays are turned round.
fn take(wave: &mut VertexWave, n: usize) {
    let VertexWave { p, n: normals, omega, side, rays } = wave;
    let list = &rays.list[..n];
    if list.iter().enumerate().all(|(i, &ray)| ray as usize == i) {
        // nothing is left out: the columns change places, and nothing is copied
        for (state, seen) in [(p, &mut rays.q), (normals, &mut rays.m), (&mut *omega, &mut rays.d)] {
            std::mem::swap(state, seen);
        }
        std::mem::swap(side, &mut rays.side);
    } else {
        for (state, seen) in [(p, &rays.q), (normals, &rays.m), (&mut *omega, &rays.d)] {
            state.gather(seen, list);
        }
        pick::gather(side, &rays.side, list);
    }
    omega.negate(n);
}
