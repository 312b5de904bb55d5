//! What a ray meets.

use super::primitive::{Candidate, Primitive};
use super::{Geometry, Hit, Ray, SurfaceId};
use crate::scene::shape::TriangleRay;

/// A search along one ray: what it needs at every primitive.
pub(super) struct Search<'a> {
    geometry: &'a Geometry,
    ray: &'a Ray,
    /// Built only where there are triangles.
    triangle_ray: Option<TriangleRay>,
    from: Option<SurfaceId>,
    /// Crossings up to this t may be the start's own surface or one that touches it.
    near: f64,
}

impl<'a> Search<'a> {
    pub(super) fn new(geometry: &'a Geometry, ray: &'a Ray, from: Option<SurfaceId>) -> Self {
        let has_triangles = !geometry.primitives.meshes.is_empty();
        let triangle_ray = has_triangles.then(|| TriangleRay::new(ray.origin, ray.direction));
        let near = if from.is_some() { geometry.near } else { 0.0 };
        Self { geometry, ray, triangle_ray, from, near }
    }

    /// The first crossing of a primitive that counts.
    #[inline(always)]
    pub(super) fn first_crossing(&self, primitive: u32) -> Option<Candidate> {
        match &self.geometry.primitives.list[primitive as usize] {
            Primitive::Triangle(_) if self.from.is_some_and(|from| from.primitive == primitive) => None,
            Primitive::Triangle(triangle) => {
                let corners = self.geometry.primitives.corners(triangle);
                let hit = self.triangle_ray.as_ref()?.meet(corners)?;
                let surface = SurfaceId { primitive, face: 0 };
                let candidate = Candidate { t: hit.t, surface, weights: hit.weights };
                (hit.t > self.near || self.counts_near_start(&candidate)).then_some(candidate)
            }
            Primitive::Analytic(index) => self.first_analytic(primitive, *index),
        }
    }

    fn first_analytic(&self, primitive: u32, index: u32) -> Option<Candidate> {
        let analytic = &self.geometry.primitives.analytic[index as usize];
        let on = self.from.filter(|from| from.primitive == primitive).map(|from| from.face);
        let mut after = -self.near;
        loop {
            let crossing = analytic.next(self.ray, on, after)?;
            let surface = SurfaceId { primitive, face: crossing.face };
            let candidate = Candidate { t: crossing.t, surface, weights: [0.0; 3] };
            if on.is_some() || crossing.t > self.near || self.counts_near_start(&candidate) {
                return Some(candidate);
            }
            after = crossing.t;
        }
    }

    fn counts_near_start(&self, candidate: &Candidate) -> bool {
        match self.from {
            Some(from) if candidate.t >= -self.near => self.geometry.follows_start(self.ray, from, candidate),
            _ => false,
        }
    }
}

impl Geometry {
    /// The nearest surface that the ray meets before `t_max`.
    ///
    /// `from` is the surface that the ray starts on; without it (a camera, a lamp in the air) only crossings at
    /// t > 0 count.
    pub fn intersect(&self, ray: &Ray, from: Option<SurfaceId>, t_max: f64) -> Option<Hit> {
        let search = Search::new(self, ray, from);
        let mut best: Option<Candidate> = None;
        let mut limit = t_max;
        self.tree.visit(ray, t_max, |primitive| {
            if let Some(candidate) = search.first_crossing(primitive)
                && candidate.t < limit + self.near
                && self.is_nearer(ray, &candidate, best.as_ref(), t_max)
            {
                limit = candidate.t;
                best = Some(candidate);
            }
            limit + self.near
        });
        best.map(|best| self.primitives.hit(ray, &best))
    }

    #[inline]
    fn is_nearer(&self, ray: &Ray, candidate: &Candidate, best: Option<&Candidate>, t_max: f64) -> bool {
        let Some(best) = best else { return candidate.t < t_max };
        if (candidate.t - best.t).abs() > self.near {
            return candidate.t < best.t;
        }
        candidate.t < t_max && self.precedes(ray, candidate, best)
    }

    /// Whether anything stands between the ray's start and `t_max`. `to` is the surface aimed at: it does not
    /// block, nor does anything that the ray would meet after it.
    pub fn occluded(&self, ray: &Ray, from: Option<SurfaceId>, to: Option<SurfaceId>, t_max: f64) -> bool {
        let search = Search::new(self, ray, from);
        let end = to.map(|surface| Candidate { t: t_max, surface, weights: [0.0; 3] });
        let mut blocked = false;
        self.tree.visit(ray, t_max + self.near, |primitive| {
            if !blocked {
                let crossing = search.first_crossing(primitive);
                blocked = crossing.is_some_and(|candidate| self.blocks(ray, &candidate, end.as_ref(), t_max));
            }
            if blocked { -1.0 } else { t_max + self.near }
        });
        blocked
    }

    fn blocks(&self, ray: &Ray, candidate: &Candidate, end: Option<&Candidate>, t_max: f64) -> bool {
        let Some(end) = end else { return candidate.t < t_max };
        if candidate.surface == end.surface {
            return false;
        }
        if (candidate.t - t_max).abs() > self.near {
            return candidate.t < t_max;
        }
        self.precedes(ray, candidate, end)
    }

    /// Calls `f` with every surface along the ray, near to far.
    pub fn for_each_hit(&self, ray: &Ray, from: Option<SurfaceId>, mut f: impl FnMut(&Hit)) {
        let (mut start, mut travelled) = (*ray, 0.0);
        let mut surface = from;
        // Hits are passed one after another as a path would pass them, so that touching surfaces keep their order.
        // A line crosses no primitive more than six times, which bounds the walk.
        for _ in 0..6 * self.primitives.list.len() {
            let Some(mut hit) = self.intersect(&start, surface, f64::INFINITY) else { return };
            travelled += hit.t;
            hit.t = travelled;
            f(&hit);
            start.origin = hit.position;
            surface = Some(hit.surface);
        }
    }
}
