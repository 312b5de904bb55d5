//! Ray intersection and occlusion.

use super::hit::{Hit, SurfaceId};
use super::primitive::{Candidate, Primitive};
use super::ray::Ray;
use super::shape::TriangleRay;
use super::world::Geometry;

/// A ray, and the data that all its primitive tests share.
pub(super) struct RayQuery<'a> {
    pub(super) geometry: &'a Geometry,
    pub(super) ray: &'a Ray,
    /// `None` if the scene has no triangles.
    pub(super) triangle_ray: Option<TriangleRay>,
    pub(super) from: Option<SurfaceId>,
    /// The largest |t| of a crossing that may coincide with the start surface.
    pub(super) coincidence_range_m: f64,
}

impl<'a> RayQuery<'a> {
    pub(super) fn new(geometry: &'a Geometry, ray: &'a Ray, from: Option<SurfaceId>) -> Self {
        let has_triangles = !geometry.primitives.meshes.is_empty();
        let triangle_ray = has_triangles.then(|| TriangleRay::new(ray.origin, ray.direction));
        let coincidence_range_m = if from.is_some() { geometry.coincidence_range_m } else { 0.0 };
        Self { geometry, ray, triangle_ray, from, coincidence_range_m }
    }

    /// Returns the first valid crossing of a primitive of the list.
    #[inline(always)]
    pub(super) fn first_crossing(&self, primitive: u32) -> Option<Candidate> {
        match &self.geometry.primitives.list[primitive as usize] {
            Primitive::Triangle(_) if self.from.is_some_and(|from| from.primitive == primitive) => None,
            Primitive::Triangle(triangle) => {
                let corners = self.geometry.primitives.corners(triangle);
                let hit = self.triangle_ray.as_ref()?.intersect(corners)?;
                let surface = SurfaceId { primitive, face: 0 };
                let candidate = Candidate { t: hit.t, surface, weights: hit.weights };
                (hit.t > self.coincidence_range_m || self.accepts_near_start(&candidate)).then_some(candidate)
            }
            Primitive::Analytic(index) => self.first_analytic(primitive, *index),
            Primitive::Instance(_) => None,
        }
    }

    fn first_analytic(&self, primitive: u32, index: u32) -> Option<Candidate> {
        let analytic = &self.geometry.primitives.analytic[index as usize];
        let start_face = self.from.filter(|from| from.primitive == primitive).map(|from| from.face);
        let mut after = -self.coincidence_range_m;
        loop {
            let crossing = analytic.next_crossing(self.ray, start_face, after)?;
            let surface = SurfaceId { primitive, face: crossing.face };
            let candidate = Candidate { t: crossing.t, surface, weights: [0.0; 3] };
            if start_face.is_some() || crossing.t > self.coincidence_range_m || self.accepts_near_start(&candidate) {
                return Some(candidate);
            }
            after = crossing.t;
        }
    }

    pub(super) fn accepts_near_start(&self, candidate: &Candidate) -> bool {
        match self.from {
            Some(from) if candidate.t >= -self.coincidence_range_m => {
                self.geometry.lies_beyond_start(self.ray, from, candidate)
            }
            _ => false,
        }
    }
}

impl Geometry {
    /// Returns the nearest hit with t < `t_max` of a ray that starts on the surface `from`. If
    /// `from` is `None` (for a camera, or a light in free space), only crossings at t > 0 count.
    pub fn intersect(&self, ray: &Ray, from: Option<SurfaceId>, t_max: f64) -> Option<Hit> {
        if self.primitives.instances.list.is_empty() {
            self.intersect_with::<false>(ray, from, t_max)
        } else {
            self.intersect_with::<true>(ray, from, t_max)
        }
    }

    #[inline]
    fn intersect_with<const INSTANCES: bool>(&self, ray: &Ray, from: Option<SurfaceId>, t_max: f64) -> Option<Hit> {
        let query = RayQuery::new(self, ray, from);
        let mut best: Option<Candidate> = None;
        let mut limit = t_max;
        self.bvh.traverse(ray, t_max, |primitive| {
            let limit_with_margin = limit + self.coincidence_range_m;
            let mut consider = |candidate: &Candidate| {
                if candidate.t < limit + self.coincidence_range_m
                    && self.is_nearer(ray, candidate, best.as_ref(), t_max)
                {
                    limit = candidate.t;
                    best = Some(*candidate);
                }
                limit + self.coincidence_range_m
            };
            if INSTANCES && let Primitive::Instance(index) = self.primitives.list[primitive as usize] {
                query.instance_crossings(index, limit_with_margin, consider);
            } else if let Some(candidate) = query.first_crossing(primitive) {
                consider(&candidate);
            }
            limit + self.coincidence_range_m
        });
        best.map(|best| self.primitives.hit(ray, &best))
    }

    #[inline]
    fn is_nearer(&self, ray: &Ray, candidate: &Candidate, best: Option<&Candidate>, t_max: f64) -> bool {
        let Some(best) = best else { return candidate.t < t_max };
        if (candidate.t - best.t).abs() > self.coincidence_range_m {
            return candidate.t < best.t;
        }
        candidate.t < t_max && self.precedes(ray, candidate, best)
    }

    /// Returns true if a surface blocks the segment from the ray's origin to `t_max`. The target
    /// surface `to` and the surfaces behind it do not block it.
    pub fn occluded(&self, ray: &Ray, from: Option<SurfaceId>, to: Option<SurfaceId>, t_max: f64) -> bool {
        if self.primitives.instances.list.is_empty() {
            self.occluded_with::<false>(ray, from, to, t_max)
        } else {
            self.occluded_with::<true>(ray, from, to, t_max)
        }
    }

    #[inline]
    fn occluded_with<const INSTANCES: bool>(
        &self,
        ray: &Ray,
        from: Option<SurfaceId>,
        to: Option<SurfaceId>,
        t_max: f64,
    ) -> bool {
        let query = RayQuery::new(self, ray, from);
        let end = to.map(|surface| Candidate { t: t_max, surface, weights: [0.0; 3] });
        let limit_with_margin = t_max + self.coincidence_range_m;
        let mut blocked = false;
        self.bvh.traverse(ray, limit_with_margin, |primitive| {
            if blocked {
                return -1.0;
            }
            if INSTANCES && let Primitive::Instance(index) = self.primitives.list[primitive as usize] {
                query.instance_crossings(index, limit_with_margin, |candidate| {
                    blocked = blocked || self.blocks(ray, candidate, end.as_ref(), t_max);
                    if blocked { -1.0 } else { limit_with_margin }
                });
            } else {
                let crossing = query.first_crossing(primitive);
                blocked = crossing.is_some_and(|candidate| self.blocks(ray, &candidate, end.as_ref(), t_max));
            }
            if blocked { -1.0 } else { limit_with_margin }
        });
        blocked
    }

    fn blocks(&self, ray: &Ray, candidate: &Candidate, end: Option<&Candidate>, t_max: f64) -> bool {
        let Some(end) = end else { return candidate.t < t_max };
        if candidate.surface == end.surface {
            return false;
        }
        if (candidate.t - t_max).abs() > self.coincidence_range_m {
            return candidate.t < t_max;
        }
        self.precedes(ray, candidate, end)
    }

    /// Calls `f` with every hit along the ray, in order of increasing distance.
    pub fn for_each_hit(&self, ray: &Ray, from: Option<SurfaceId>, mut f: impl FnMut(&Hit)) {
        let (mut start, mut travelled) = (*ray, 0.0);
        let mut surface = from;
        // The search for the next hit starts at the previous hit, so touching surfaces keep their
        // order. A line crosses a primitive at most six times.
        for _ in 0..6 * self.primitive_count() {
            let Some(mut hit) = self.intersect(&start, surface, f64::INFINITY) else { return };
            travelled += hit.t;
            hit.t = travelled;
            f(&hit);
            start.origin = hit.position;
            surface = Some(hit.surface);
        }
    }
}
