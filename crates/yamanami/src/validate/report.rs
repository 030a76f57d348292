//! What a validation finds: breaches of rules, cracks by pair of levels, errors by level.

use super::rules::severity;
use std::collections::BTreeMap;
use yamanami_io::inspect::Fault;

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Broken: viewers show it wrongly or not at all, or a promise is not kept.
    Error,
    /// Doubtful.
    Warning,
    /// Worth knowing.
    Note,
}

impl std::fmt::Display for Severity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Note => "note",
        })
    }
}

/// One breach of a rule.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Finding {
    /// How bad.
    pub severity: Severity,
    /// Which rule, as in [`super::RULES`].
    pub code: &'static str,
    /// The tile or file; empty for the whole.
    pub tile: String,
    /// Where in it.
    pub place: String,
    /// What should be there.
    pub expected: String,
    /// What is there.
    pub found: String,
    /// How often in this tile.
    pub count: u64,
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { severity, code, tile, place, expected, found, count } = self;
        write!(f, "{code} {severity}: ")?;
        for part in [tile, place].into_iter().filter(|part| !part.is_empty()) {
            write!(f, "{part}: ")?;
        }
        write!(f, "expected {expected}, found {found}")?;
        if *count > 1 { write!(f, " (and {} more here)", count - 1) } else { Ok(()) }
    }
}

/// The greatest crack between tiles of two levels.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct CrackRow {
    /// Level of the coarser tile.
    pub coarse: u32,
    /// Level of the finer tile.
    pub fine: u32,
    /// Pairs of sides that were held against each other.
    pub pairs: u64,
    /// Greatest distance in metres: vertical for terrain on a globe, in space for 3D Tiles.
    pub max_m: f64,
    /// Pairs that gape by more than is tolerated.
    pub over: u64,
    /// Greatest share of a side along which only one of both is.
    pub uncovered: f64,
    /// Longitude and latitude of the greatest in degrees; for tiles not on the globe x and y.
    pub worst: [f64; 2],
}

/// Declared and measured error of a level.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct ErrorRow {
    /// The level.
    pub level: u32,
    /// Tiles measured.
    pub tiles: u64,
    /// Greatest error declared, metres.
    pub declared_m: f64,
    /// Greatest distance to the finest descendants, metres; 0 where there are none.
    pub measured_m: f64,
    /// Greatest ratio of measured to declared among the tiles.
    pub ratio: f64,
    /// Samples of the source in the tiles, and those that no triangle covers.
    pub samples: [u64; 2],
    /// Greatest and root mean square vertical distance of the source's samples, metres.
    pub source_m: [f64; 2],
    /// Greatest ratio of that to declared among the tiles.
    pub source_ratio: f64,
    /// Shift of the tiles in plan, samples of the source to the right and downwards.
    pub shift: Option<[f64; 2]>,
}

/// All that was found.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct ValidateReport {
    /// What it is, like `quantized-mesh pyramid`.
    pub kind: String,
    /// Tiles there are, and tiles that were looked at.
    pub tiles: [u64; 2],
    /// Bytes read of those looked at, as stored.
    pub bytes: u64,
    /// Triangles in them.
    pub triangles: u64,
    /// Breaches, the worst first; of each rule at most [`ValidateReport::SHOWN`].
    pub findings: Vec<Finding>,
    /// Breaches of each rule, those not in the list included.
    pub counts: BTreeMap<&'static str, u64>,
    /// Cracks by pair of levels.
    pub cracks: Vec<CrackRow>,
    /// Errors by level.
    pub errors: Vec<ErrorRow>,
}

impl ValidateReport {
    /// Findings kept for each rule.
    pub const SHOWN: u64 = 10;

    /// Breaches of a severity.
    pub fn count(&self, of: Severity) -> u64 {
        self.counts.iter().filter(|(code, _)| severity(code) == of).map(|(_, count)| count).sum()
    }

    pub(super) fn new(kind: impl Into<String>) -> Self {
        Self { kind: kind.into(), ..Self::default() }
    }

    /// A breach.
    pub(super) fn add(
        &mut self,
        code: &'static str,
        tile: &str,
        place: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) {
        self.push(Finding {
            severity: severity(code),
            code,
            tile: tile.to_owned(),
            place: place.into(),
            expected: expected.into(),
            found: found.into(),
            count: 1,
        });
    }

    /// Breaches that a reader or a check has listed.
    pub(super) fn add_all(&mut self, tile: &str, faults: Vec<Fault>) {
        for fault in faults {
            self.push(Finding {
                severity: severity(fault.code),
                code: fault.code,
                tile: tile.to_owned(),
                place: fault.place,
                expected: fault.expected,
                found: fault.found,
                count: fault.count,
            });
        }
    }

    fn push(&mut self, finding: Finding) {
        let count = self.counts.entry(finding.code).or_default();
        *count += 1;
        if *count <= Self::SHOWN {
            self.findings.push(finding);
        }
    }

    pub(super) fn sort(&mut self) {
        self.findings.sort_by_key(|f| f.severity);
        self.cracks.sort_by_key(|r| (r.coarse, r.fine));
        self.errors.sort_by_key(|r| r.level);
    }
}
