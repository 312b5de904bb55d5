//! Importance-driven photon emission.
//!
//! Two random numbers select the direction of a ray that a light emits, or its position for a beam
//! or a distant light. A tree divides their unit square into rectangles, whose densities the pilot
//! learns before pass 0 (see `pilot::aim_tree`). A small part of the density is the same
//! everywhere, so every direction keeps a positive one, no photon becomes more than
//! 1/[`DEFENSIVE`] times as powerful as without aim, and the estimate stays unbiased. The random
//! numbers are warped from node to node, which preserves the uniformity of low-discrepancy points
//! inside of every rectangle. Sources: Jensen 1995 (projection maps); Peter & Pietrek 1998,
//! "Importance Driven Construction of Photon Maps"; Clarberg et al. 2005, "Wavelet Importance
//! Sampling" (hierarchical warping); Hesterberg 1995 (defensive sampling).

/// The part of the density that is the same everywhere.
const DEFENSIVE: f64 = 0.05;

/// The learned emission distribution of one stratum of a light's rays. Without nodes, it is uniform.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Aim {
    nodes: Vec<Node>,
}

/// A division of the unit square into rectangles by halving, with a number of any scale for each.
#[derive(Debug, Clone, PartialEq)]
pub enum AimTree {
    Leaf(f64),
    Halves { axis: usize, halves: Box<[AimTree; 2]> },
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Node {
    Leaf {
        /// The density of its rectangle, relative to uniform sampling.
        relative_pdf: f64,
    },
    Halves {
        axis: usize,
        /// The probability of the first half, relative to this node.
        first_probability: f64,
        /// The index of the node of the first half. The second one follows.
        first: usize,
    },
}

impl Aim {
    pub fn plain() -> Self {
        Self::default()
    }

    /// Takes the density of each rectangle in any unit. Without any, the distribution is uniform.
    pub fn learned(densities: &AimTree) -> Self {
        let integral = densities.integral();
        let mut aim = Self::plain();
        if integral > 0.0 && matches!(densities, AimTree::Halves { .. }) {
            aim.nodes.push(Node::Leaf { relative_pdf: 1.0 });
            aim.fill(0, densities, integral);
        }
        aim
    }

    /// Fills a node and appends those below it. Returns the mean density of its rectangle.
    fn fill(&mut self, node: usize, densities: &AimTree, integral: f64) -> f64 {
        match densities {
            AimTree::Leaf(density) => {
                let relative_pdf = DEFENSIVE + (1.0 - DEFENSIVE) * density / integral;
                self.nodes[node] = Node::Leaf { relative_pdf };
                relative_pdf
            }
            AimTree::Halves { axis, halves } => {
                let first = self.nodes.len();
                self.nodes.extend([Node::Leaf { relative_pdf: 1.0 }; 2]);
                let [a, b] = [0, 1].map(|half| self.fill(first + half, &halves[half], integral));
                self.nodes[node] = Node::Halves { axis: *axis, first_probability: a / (a + b), first };
                0.5 * (a + b)
            }
        }
    }

    pub fn is_plain(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Maps `u` in [0, 1)² to a point of the square. Returns the point and its relative pdf.
    #[inline]
    pub fn sample(&self, mut u: [f64; 2]) -> ([f64; 2], f64) {
        const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;
        let (mut low, mut size, mut node) = ([0.0; 2], [1.0; 2], 0);
        let relative_pdf = loop {
            match self.nodes.get(node) {
                None => return (u, 1.0),
                Some(Node::Leaf { relative_pdf }) => break *relative_pdf,
                Some(&Node::Halves { axis, first_probability, first }) => {
                    size[axis] *= 0.5;
                    let along = u[axis];
                    if along < first_probability {
                        u[axis] = along / first_probability;
                        node = first;
                    } else {
                        u[axis] = (along - first_probability) / (1.0 - first_probability);
                        low[axis] += size[axis];
                        node = first + 1;
                    }
                    u[axis] = u[axis].min(BELOW_ONE);
                }
            }
        };
        ([0, 1].map(|axis| (low[axis] + size[axis] * u[axis]).min(BELOW_ONE)), relative_pdf)
    }

    /// Returns the pdf at a point of the square, relative to uniform sampling.
    pub fn relative_pdf(&self, mut point: [f64; 2]) -> f64 {
        let mut node = 0;
        loop {
            match self.nodes.get(node) {
                None => return 1.0,
                Some(Node::Leaf { relative_pdf }) => return *relative_pdf,
                Some(&Node::Halves { axis, first, .. }) => {
                    point[axis] *= 2.0;
                    node = first;
                    if point[axis] >= 1.0 {
                        point[axis] -= 1.0;
                        node += 1;
                    }
                }
            }
        }
    }

    /// Returns the mean density of the samples, relative to uniform sampling.
    pub fn mean_relative_pdf(&self) -> f64 {
        // The mean over the samples is the integral of the squared density.
        if self.is_plain() { 1.0 } else { self.integral_of_square(0, 1.0) }
    }

    fn integral_of_square(&self, node: usize, area: f64) -> f64 {
        match self.nodes[node] {
            Node::Leaf { relative_pdf } => area * relative_pdf * relative_pdf,
            Node::Halves { first, .. } => {
                self.integral_of_square(first, 0.5 * area) + self.integral_of_square(first + 1, 0.5 * area)
            }
        }
    }
}

impl AimTree {
    /// Returns the integral of the numbers over the square.
    pub fn integral(&self) -> f64 {
        match self {
            Self::Leaf(density) => *density,
            Self::Halves { halves, .. } => 0.5 * (halves[0].integral() + halves[1].integral()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::sobol::Sobol;

    fn halves(axis: usize, first: AimTree, second: AimTree) -> AimTree {
        AimTree::Halves { axis, halves: Box::new([first, second]) }
    }

    /// The mean of 1/density is 1, each rectangle receives its fraction of the samples, and the
    /// density of a sample is that of its point.
    #[test]
    fn aiming_preserves_the_mean_power() {
        let quarter = halves(1, AimTree::Leaf(0.0), AimTree::Leaf(6.0));
        let aim = Aim::learned(&halves(0, AimTree::Leaf(1.0), quarter));
        let sobol = Sobol::new(1);
        let n = 1 << 14;
        let (mut power, mut inside, mut density) = (0.0, 0, 0.0);
        for i in 0..n {
            let (point, relative_pdf) = aim.sample([sobol.at(i, 0), sobol.at(i, 1)]);
            assert_eq!(relative_pdf, aim.relative_pdf(point), "{point:?}");
            power += 1.0 / relative_pdf / f64::from(n);
            density += relative_pdf / f64::from(n);
            inside += usize::from(point[0] >= 0.5 && point[1] >= 0.5);
        }
        assert!((power - 1.0).abs() < 2e-3, "{power}");
        let expected = 0.25 * DEFENSIVE + (1.0 - DEFENSIVE) * 0.75;
        assert!((inside as f64 / f64::from(n) - expected).abs() < 1e-3, "{inside}");
        assert!((density - aim.mean_relative_pdf()).abs() < 1e-2, "{density}");
    }

    /// Numbers at the ends of their range stay inside of the square.
    #[test]
    fn extreme_numbers_stay_inside_of_the_square() {
        let one = 1.0 - f64::EPSILON / 2.0;
        let aim = Aim::learned(&halves(0, AimTree::Leaf(1.0), halves(1, AimTree::Leaf(1e-30), AimTree::Leaf(1e30))));
        for u in [[0.0, 0.0], [one, one], [0.0, one], [one, 0.0]] {
            let (point, relative_pdf) = aim.sample(u);
            assert!(point.iter().all(|x| (0.0..1.0).contains(x)), "{point:?}");
            assert!(relative_pdf >= DEFENSIVE, "{relative_pdf}");
        }
    }
}
