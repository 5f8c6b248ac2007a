//! Final gather: the radiosity solution seen through the camera, with one sampled application of T at each pixel.
//!
//! `(T^k E)(x) ≈ weight · (T_h^{k−1} E)_{j(y)}`. Here x is the point that the pixel sees, and y is the point hit by one ray
//! that scatters at x. For k = 0 the value is E(x) itself. This is the Sloan iterate `E + T B_h`. It is 5 to 20 times closer
//! to the limit of fine meshes than the value of the patch under the pixel. One ray serves all k at once. For k = 1 the
//! patch would show E itself, so **T¹ does not test the matrix**. It is estimated like the direct light of all other
//! estimators, by connections and hits with MIS.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | `T_h^k E` | terms per patch | [`Gather::terms`] |
//! | j(y) | the patch of a point | [`Patches::locate`] |
//! | B_h | the solution per patch, Σ over all k of `T_h^k E` | [`Gather::new`] |
//! | slot K + 1 | the tail: `B_h − Σ_{k≤K} T_h^k E` | [`Gather::tail`] |
//!
//! Reference: Sloan, *Improvement by iteration for compact operator equations* (Math. Comp. 30, 1976); in rendering, the
//! final gather of Reichert (1992).

use super::{Job, Paths, Technique, TermEstimator, TermSink};
use crate::math::Columns;
use crate::operator::{SceneTransport, Sensor, patches::Patches};
use crate::scene::{Vertex, VertexWave};
use glam::DVec3;

/// An estimator that shows the terms of a matrix through a camera.
#[derive(Clone, Debug)]
pub struct Gather<'a> {
    /// The mesh.
    pub patches: &'a Patches,
    /// `T_h^k E` per patch, k = 0..=K.
    pub terms: &'a [Vec<DVec3>],
    /// `B_h − Σ_{k≤K} T_h^k E` per patch.
    pub tail: Vec<DVec3>,
    /// If true, a pixel shows the patch under it, without gathering.
    pub read_patches: bool,
}

impl<'a> Gather<'a> {
    /// A gather from the terms k = 0..=K and the solution B_h per patch.
    pub fn new(patches: &'a Patches, terms: &'a [Vec<DVec3>], solution: &[DVec3], read_patches: bool) -> Self {
        let rest = |(i, b): (usize, &DVec3)| *b - terms.iter().map(|t| t[i]).sum::<DVec3>();
        Self { patches, terms, tail: solution.iter().enumerate().map(rest).collect(), read_patches }
    }

    fn patch(&self, v: &Vertex) -> Option<usize> {
        self.patches.locate((v.side / 2) as usize, v.side & 1 == 0, v.p.as_dvec3())
    }
}

impl<'s> TermEstimator<SceneTransport<'s>> for Gather<'_> {
    fn slots(&self) -> usize {
        self.terms.len() + 1
    }

    fn sample<S: Sensor<SceneTransport<'s>>>(
        &self,
        job: &Job<'_, SceneTransport<'s>, S>,
        paths: &mut Paths<VertexWave>,
        sink: &mut impl TermSink,
    ) {
        let &Job { t, batch, .. } = job;
        paths.start(job);
        sink.rays(0, batch.len());
        let tail = self.terms.len();
        // `shift`: number of bounces between the pixel and the patch that is read; `read`: first slot that is read from a
        // patch
        let shift = usize::from(!self.read_patches);
        let read = if self.read_patches { 0 } else { tail.min(2) };
        // if K = 0, slot 1 is the tail, and its direct light is sampled as in all other estimators
        if !self.read_patches {
            paths.emission(t);
            paths.add(0, sink);
            sink.rays(1, paths.n);
            paths.connect(t, 0);
            paths.score_connections(Technique::Mis, 1, sink);
            sink.rays(read, paths.n);
            paths.scatter(t, 0);
            paths.emission(t);
            paths.score_hits(Technique::Mis, 1, sink);
        }
        let at: Vec<Option<usize>> = (0..paths.n).map(|i| self.patch(&paths.state.get(i))).collect();
        let mut value = Columns::new(paths.n);
        for slot in read..=tail {
            for (i, patch) in at.iter().enumerate() {
                // slot k reads T_h^(k − shift) E; if a bounce lies between, the tail also reads T_h^K E, unless that is E,
                // sampled above
                let radiance = patch.map_or(DVec3::ZERO, |j| match slot {
                    s if s < tail => self.terms[s - shift][j],
                    _ if self.read_patches || tail == 1 => self.tail[j],
                    _ => self.tail[j] + self.terms[tail - 1][j],
                });
                value.set(i, paths.throughput.get(i) * radiance.as_vec3());
            }
            sink.add(slot, &paths.pixel[..paths.n], &paths.sample[..paths.n], &value);
        }
    }
}
