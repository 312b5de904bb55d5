//! The table of the missing energy for all roughnesses, indices and angles, read from
//! `data/microfacets/missing_energy.csv.gz`.
//!
//! The nodes are dense where the missing energy changes fast: at indices near 1, and at grazing
//! angles of smooth surfaces. The interpolation is cubic in all three dimensions.

use super::FacetKind;
use crate::math::cubic::CubicStencil;
use crate::math::elementary::{asin, exp, ln, powf, sin};
use crate::optics::microfacet::{Ggx, MIN_ALPHA};
use crate::spectrum::embedded::unpack;
use std::sync::OnceLock;

/// The packed file of the table.
static FILE: &[u8] = include_bytes!("../../../../data/microfacets/missing_energy.csv.gz");

/// The number of roughnesses in the table.
const ALPHAS: usize = 16;
/// The number of relative indices above 1, which equals the number of relative indices below 1.
const INDICES_PER_SIDE: usize = 28;
/// The number of relative indices in the table. The last row of a roughness is that of a mirror.
const INDICES: usize = 2 * INDICES_PER_SIDE + 1;
/// The number of angles in the table.
const ANGLES: usize = 48;

/// The logarithm of the largest relative index in the table. Beyond it, the last row is used.
const LARGEST_LOG_INDEX: f64 = 2.25;

/// The logarithm of the missing energy is interpolated, because it is smooth over many orders of
/// magnitude. This value is added to the missing energy, so that the logarithm stays finite.
const FLOOR: f64 = 1e-2;

/// The missing energy of all interfaces.
#[derive(Debug)]
pub(super) struct MissingEnergyTable {
    /// The rows of all relative indices and of the mirror, for one roughness after the other.
    rows: Vec<Row>,
}

/// One row of the table.
#[derive(Debug, Clone, PartialEq)]
struct Row {
    /// The logarithm of the missing energy at each angle.
    log_missing: [f64; ANGLES],
    /// The mean of the energy that single scattering transmits.
    transmitted: f64,
}

/// The missing energy of one interface.
#[derive(Debug)]
pub(super) struct Column {
    alpha: f64,
    log_missing: [f64; ANGLES],
    /// The mean of the energy that single scattering transmits.
    pub(super) transmitted: f64,
}

impl MissingEnergyTable {
    /// Returns the table that is built into the program.
    pub(super) fn built_in() -> &'static Self {
        static TABLE: OnceLock<MissingEnergyTable> = OnceLock::new();
        TABLE.get_or_init(|| Self { rows: unpack(FILE).lines().skip(1).map(parse).collect() })
    }

    /// Interpolates the missing energy of an interface.
    pub(super) fn column(&self, facets: &Ggx, kind: FacetKind) -> Column {
        let of_alpha = CubicStencil::new(alpha_position(facets.alpha()), ALPHAS);
        let (first, of_index) = match kind {
            FacetKind::Mirror => (INDICES, None),
            FacetKind::Dielectric(index) => {
                let position = index_position(index);
                // The missing energy has a bend at index 1, so each side is interpolated by itself.
                let side = if position < INDICES_PER_SIDE as f64 { 0 } else { INDICES_PER_SIDE };
                (side, Some(CubicStencil::new(position - side as f64, INDICES_PER_SIDE + 1)))
            }
        };
        let mut column = Column { alpha: facets.alpha(), log_missing: [0.0; ANGLES], transmitted: 0.0 };
        for (alpha, weight) in of_alpha.nodes() {
            let row = |index: usize| &self.rows[alpha * (INDICES + 1) + first + index];
            match &of_index {
                None => column.add(row(0), weight),
                Some(of_index) => of_index.nodes().for_each(|(index, share)| column.add(row(index), weight * share)),
            }
        }
        column
    }
}

impl Column {
    fn add(&mut self, row: &Row, weight: f64) {
        self.log_missing.iter_mut().zip(&row.log_missing).for_each(|(sum, value)| *sum += weight * value);
        self.transmitted += weight * row.transmitted;
    }

    /// Returns the missing energy at a cosine in \[0, 1\].
    pub(super) fn at(&self, cos: f64) -> f64 {
        let stencil = CubicStencil::new(angle_position(cos, self.alpha), ANGLES);
        let log: f64 = stencil.nodes().map(|(angle, weight)| weight * self.log_missing[angle]).sum();
        (exp(log) - FLOOR).clamp(0.0, 1.0)
    }
}

/// Reads one line of the table: a roughness, an index, and millionths of the energies.
fn parse(line: &str) -> Row {
    let millionths =
        line.split(',').skip(2).map(|cell| 1e-6 * cell.parse::<f64>().expect("the built-in table is valid"));
    let mut row = Row { log_missing: [ln(FLOOR); ANGLES], transmitted: 0.0 };
    for (place, value) in millionths.enumerate() {
        match row.log_missing.get_mut(place) {
            Some(log) => *log = ln(value + FLOOR),
            None => row.transmitted = value,
        }
    }
    row
}

/// Returns the position of a roughness among the nodes, which are evenly spaced in its fourth root.
fn alpha_position(alpha: f64) -> f64 {
    let least = powf(MIN_ALPHA, 0.25);
    (powf(alpha, 0.25) - least) / (1.0 - least) * (ALPHAS - 1) as f64
}

/// Returns the position of a relative index among the nodes, which are evenly spaced in the fourth
/// root of its logarithm.
fn index_position(index: f64) -> f64 {
    let log = ln(index) / LARGEST_LOG_INDEX;
    let root = powf(log.abs(), 0.25).min(1.0).copysign(log);
    (1.0 + root) * INDICES_PER_SIDE as f64
}

/// Returns the position of a cosine among the nodes. The missing energy is nearly a function of
/// μ/α, so the nodes are spaced in y = (1 + α)·μ/(μ + α). They are dense at both ends.
fn angle_position(cos: f64, alpha: f64) -> f64 {
    let y = (1.0 + alpha) * cos / (cos + alpha);
    // The inverse of y = w²·(3 − 2w).
    let w = 0.5 - sin(asin((1.0 - 2.0 * y).clamp(-1.0, 1.0)) / 3.0);
    w * (ANGLES - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::super::quadrature::{mean_transmitted, missing_and_transmitted};
    use super::*;
    use crate::spectrum::embedded::pack;
    use rayon::prelude::*;
    use std::fmt::Write;

    /// The largest error of the table between its nodes. The quadrature itself is accurate to about
    /// 3·10⁻⁴ where total reflection begins.
    const LARGEST_ERROR: f64 = 1.5e-3;

    fn alpha(node: usize) -> f64 {
        let least = MIN_ALPHA.powf(0.25);
        (least + (1.0 - least) * node as f64 / (ALPHAS - 1) as f64).powi(4)
    }

    fn kind(node: usize) -> FacetKind {
        let root = node as f64 / INDICES_PER_SIDE as f64 - 1.0;
        let index = (LARGEST_LOG_INDEX * root.powi(3) * root.abs()).exp();
        if node < INDICES { FacetKind::Dielectric(index) } else { FacetKind::Mirror }
    }

    fn cosine(node: usize, alpha: f64) -> f64 {
        let w = node as f64 / (ANGLES - 1) as f64;
        let y = w * w * (3.0 - 2.0 * w);
        (alpha * y / (1.0 + alpha - y)).min(1.0)
    }

    #[test]
    fn the_table_is_complete_and_its_nodes_are_where_it_is_read() {
        let table = MissingEnergyTable::built_in();
        assert_eq!(table.rows.len(), ALPHAS * (INDICES + 1));
        let fields = 2 + ANGLES + 1;
        assert!(unpack(FILE).lines().all(|line| line.split(',').count() == fields));
        for node in 0..ALPHAS {
            assert!((alpha_position(alpha(node)) - node as f64).abs() < 1e-9);
        }
        for node in 0..INDICES {
            let FacetKind::Dielectric(index) = kind(node) else { panic!("a dielectric") };
            assert!((index_position(index) - node as f64).abs() < 1e-9, "{index}");
        }
        for node in 0..ANGLES {
            assert!((angle_position(cosine(node, 0.1), 0.1) - node as f64).abs() < 1e-6);
        }
    }

    #[test]
    #[ignore = "minutes: computes all values; with ABBE_BLESS it writes the table"]
    fn the_built_in_table_of_missing_energy_is_the_quadrature() {
        let mut header = String::from("alpha,index");
        (0..ANGLES).for_each(|angle| write!(header, ",missing_{angle}_1e-6").expect("a string grows"));
        let line = |row: usize| {
            let (alpha, kind) = (alpha(row / (INDICES + 1)), kind(row % (INDICES + 1)));
            let facets = Ggx::new(alpha);
            let mut line = match kind {
                FacetKind::Mirror => format!("{alpha:.6},mirror"),
                FacetKind::Dielectric(index) => format!("{alpha:.6},{index:.6}"),
            };
            let missing = (0..ANGLES).map(|angle| missing_and_transmitted(&facets, kind, cosine(angle, alpha)).0);
            for value in missing.chain([mean_transmitted(&facets, kind)]) {
                write!(line, ",{}", (1e6 * value).round()).expect("a string grows");
            }
            line
        };
        let lines: Vec<String> = (0..ALPHAS * (INDICES + 1)).into_par_iter().map(line).collect();
        let text = format!("{header},transmitted_1e-6\n{}\n", lines.join("\n"));
        if std::env::var_os("ABBE_BLESS").is_some() {
            let path = concat!(env!("CARGO_MANIFEST_DIR"), "/data/microfacets/missing_energy.csv.gz");
            std::fs::write(path, pack(&text)).expect("the table is written");
        } else {
            assert!(text == unpack(FILE), "the table and the quadrature differ");
        }
    }

    /// The positions lie between the nodes in all three dimensions. At indices between 1/1.1 and
    /// 1.1, the interpolation is less accurate at grazing angles.
    #[test]
    fn interpolated_missing_energy_agrees_with_the_quadrature() {
        let mut worst = (0.0_f64, String::new());
        for step in 0..80_u32 {
            let [a, n, c] = [0.754_877_67, 0.569_840_29, 0.618_033_99].map(|golden| (f64::from(step) * golden).fract());
            let alpha = 0.0025_f64.powf(1.0 - a);
            let index = (1.1_f64.ln() + (2.4_f64 / 1.1).ln() * (2.0 * n - 1.0).abs()).exp().powf((n - 0.5).signum());
            let cos = c * c;
            let (facets, kind) = (Ggx::new(alpha), FacetKind::Dielectric(index));
            let error = MissingEnergyTable::built_in().column(&facets, kind).at(cos)
                - missing_and_transmitted(&facets, kind, cos).0;
            if error.abs() > worst.0.abs() {
                worst = (error, format!("alpha {alpha:.4}, index {index:.4}, cosine {cos:.4}"));
            }
        }
        println!("worst error {:.1e} at {}", worst.0, worst.1);
        assert!(worst.0.abs() < LARGEST_ERROR, "{worst:?}");
    }
}
