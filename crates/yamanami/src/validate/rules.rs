//! The rules that tiles are judged by, each with a code that stays. `docs/validate.md` lists them.
//!
//! Formats: Cesium, "Quantized-mesh-1.0"; OGC, "3D Tiles 1.0" and "1.1"; Khronos, "glTF 2.0"; Maxar, "3TZ 1.3"; Protomaps,
//! "PMTiles 3"; Mapbox, "TileJSON".

use super::report::Severity::{self, Error, Note, Warning};

/// A rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Rule {
    /// Code: what it is about, and a number.
    pub code: &'static str,
    /// How bad it is when it is broken.
    pub severity: Severity,
    /// What it says.
    pub text: &'static str,
}

const fn rule(code: &'static str, severity: Severity, text: &'static str) -> Rule {
    Rule { code, severity, text }
}

/// All rules, by what they are about.
pub const RULES: &[Rule] = &[
    rule("QM01", Error, "a packed tile is a whole gzip stream"),
    rule("QM02", Error, "header, vertices, triangles and side lists are as long as their counts say"),
    rule("QM03", Error, "all numbers of the header are finite"),
    rule("QM04", Error, "the least height is not above the greatest"),
    rule("QM05", Error, "u, v and height of every vertex lie in 0..32767"),
    rule("QM06", Error, "codes of corners do not pass the high-water mark"),
    rule("QM07", Error, "corners and side lists name vertices that are there"),
    rule("QM08", Warning, "corners have the size that the vertex count asks for, without wrapping at 16 bits"),
    rule("QM09", Warning, "every triangle has an area in plan"),
    rule("QM10", Error, "every triangle turns counter-clockwise seen from above"),
    rule("QM11", Error, "the vertices listed for a side lie on it"),
    rule("QM12", Error, "every vertex on a side is listed for it"),
    rule("QM13", Error, "the bounding sphere holds every vertex"),
    rule("QM14", Note, "the centre is that of the tile"),
    rule("QM15", Warning, "the horizon occlusion point hides nothing that can be seen"),
    rule("QM16", Note, "the heights of the header are about those of the vertices"),
    rule("QM17", Error, "extensions are as long as they say and as their kind asks for"),
    rule("QM18", Warning, "normals point up"),
    rule("QM19", Error, "the triangles fill the tile"),
    rule("QM20", Error, "the triangles do not overlap"),
    rule(
        "QM21",
        Error,
        "the tile lies where its path says: rows count from the south unless layer.json says otherwise",
    ),
    rule("QM22", Error, "the metadata extension is JSON of the length stated"),
    rule("QM23", Note, "extensions are of a known kind"),
    rule("QM24", Warning, "every vertex belongs to a triangle"),
    rule("QM25", Error, "inside a tile every edge has a triangle on either side: no slits, no T-vertices"),
    rule("QM26", Warning, "the availability of the metadata extension names tiles that are there"),
    rule(
        "QM27",
        Error,
        "tiles have a metadata extension only where layer.json has metadataAvailability: CesiumJS takes no other",
    ),
    rule("LJ01", Error, "layer.json is there and is a JSON object"),
    rule("LJ02", Error, "layer.json says format quantized-mesh-1.x and a TileJSON version"),
    rule("LJ03", Error, "layer.json has a tiles template with {z}, {x} and {y}"),
    rule("LJ04", Error, "scheme is tms or slippyMap, projection EPSG:4326 or EPSG:3857"),
    rule("LJ05", Error, "bounds are four numbers on the globe, west before east and south before north"),
    rule("LJ06", Error, "tiles that layer.json says are available are there"),
    rule("LJ07", Warning, "tiles that are there are said to be available"),
    rule("LJ08", Warning, "minzoom and maxzoom are those of the tiles"),
    rule("PY01", Error, "every tile has a parent, up to the root"),
    rule("PY02", Error, "all root tiles are there"),
    rule("CR01", Error, "neighbouring tiles of one level do not gape"),
    rule("CR02", Warning, "a tile and the descendants of its neighbour do not gape, whatever the level"),
    rule("CR03", Error, "tiles reach along the whole of a side that they share"),
    rule("ER01", Error, "the error declared is not below the one measured against the finest descendants"),
    rule("ER02", Warning, "the same for the error that the format implies by the zoom"),
    rule("ER03", Error, "the error declared is not below the one measured against the source's samples"),
    rule("ER04", Error, "every sample of the source within the tiles' bounds is covered"),
    rule("ER05", Error, "tiles are not displaced from the source"),
    rule("ER06", Warning, "what is said to have no error has none against the source"),
    rule("ER07", Error, "tiles cover what their finest descendants cover"),
    rule("TS01", Error, "a tileset is a JSON object"),
    rule("TS02", Error, "asset, geometricError, root and each tile's boundingVolume and geometricError are there"),
    rule("TS03", Error, "asset.version is 1.0 or 1.1"),
    rule("TS04", Error, "geometricError is a number, not negative"),
    rule("TS05", Error, "geometricError does not rise from a tile to its child"),
    rule("TS06", Error, "a bounding volume holds the content of all descendants"),
    rule("TS07", Error, "a bounding volume holds its tile's content"),
    rule("TS08", Error, "refine is ADD or REPLACE, and the root has it"),
    rule("TS09", Error, "content that is named is there"),
    rule("TS10", Error, "content is of a kind that 3D Tiles know"),
    rule("TS11", Error, "transforms are affine, without shear or mirror"),
    rule("TS12", Warning, "content of a tileset on the globe lies near the ground"),
    rule("TS13", Error, "the tileset's geometricError is not below its root's"),
    rule("TS14", Error, "bounding volumes are a region, a box or a sphere with a size"),
    rule("TS15", Error, "external tilesets do not include each other in a circle"),
    rule("TS16", Note, "content is looked into"),
    rule("TS17", Error, "extensions required are known"),
    rule("IM01", Error, "implicit tiling has a scheme, subtreeLevels, availableLevels and a subtree template"),
    rule("IM02", Error, "subtrees that are available are there"),
    rule("IM03", Error, "a subtree has its header, the lengths stated and its fields"),
    rule("IM04", Error, "buffers and buffer views of a subtree are within what is there"),
    rule("IM05", Error, "bitstreams are as long as the levels ask for, without bits beyond"),
    rule("IM06", Error, "availableCount is the number of available items"),
    rule("IM07", Error, "an available tile has an available parent"),
    rule("IM08", Error, "content is only where a tile is"),
    rule("IM09", Error, "nothing is available below availableLevels"),
    rule("IM10", Error, "the metadata of tiles are as many as the tiles"),
    rule("IM11", Warning, "content files that are there belong to a tile"),
    rule("GL01", Error, "a binary glTF's header and chunks have the lengths stated"),
    rule("GL02", Error, "the document is glTF 2.0 with nodes and meshes that are there"),
    rule("GL03", Error, "accessors and buffer views lie within their buffer"),
    rule("GL04", Error, "indices name vertices that are there"),
    rule("GL05", Error, "min and max of accessors are those of their numbers"),
    rule("GL06", Error, "normals have unit length"),
    rule("GL07", Error, "extensions that are used or required are declared"),
    rule("GL08", Note, "triangles have an area"),
    rule("GL09", Error, "positions are finite"),
    rule("GL10", Error, "triangles turn as their normals say"),
    rule("GL11", Error, "what meshopt has packed can be unpacked"),
    rule("GL12", Note, "everything in the glTF is looked into"),
    rule("TZ01", Error, "a 3tz archive is a zip archive"),
    rule("TZ02", Error, "its index is its last entry, of 24 bytes each"),
    rule("TZ03", Error, "the index is sorted by hash"),
    rule("TZ04", Error, "the index has the hash of every name, and no other"),
    rule("TZ05", Error, "the index has the offset of every entry"),
    rule("TZ06", Error, "there is a tileset.json at the top"),
    rule("TZ07", Error, "entries are stored or packed by deflate or zstd"),
    rule("TZ08", Error, "names are paths below the archive"),
    rule("RT01", Error, "a raster tile is a whole PNG of heights"),
    rule("RT02", Error, "all raster tiles have one size"),
    rule("RT03", Note, "raster tiles are square, of 256 or 512 pixels"),
    rule("RT04", Error, "neighbouring raster tiles fit together"),
    rule("RT05", Error, "a raster tile's heights are those of its children"),
    rule("RT06", Warning, "every raster tile has a parent, up to the least zoom"),
    rule("PM01", Error, "a PMTiles archive has a header of version 3"),
    rule("PM02", Error, "its sections and tiles lie within the file"),
    rule("PM03", Error, "its directories are whole"),
    rule("PM04", Error, "entries are sorted and do not overlap"),
    rule("PM05", Error, "the counts of the header are those of the entries"),
    rule("PM06", Error, "the metadata is a JSON object"),
    rule("PM07", Error, "the zooms of the header are those of the tiles"),
    rule("PM08", Error, "the bounds lie on the globe"),
    rule("PM09", Error, "the root directory lies within the first 16 KiB"),
    rule("PM10", Note, "compressions are ones that are read here"),
    rule("PM11", Error, "the tiles are PNG, as the header says"),
];

/// How bad a breach is.
pub(super) fn severity(code: &str) -> Severity {
    RULES.iter().find(|r| r.code == code).map_or(Error, |r| r.severity)
}

#[cfg(test)]
mod tests {
    use super::RULES;

    #[test]
    fn codes_are_unique_and_in_the_documentation() {
        let page = include_str!("../../../../docs/validate.md");
        for (k, rule) in RULES.iter().enumerate() {
            assert!(RULES[..k].iter().all(|other| other.code != rule.code), "{} twice", rule.code);
            let row = format!("| {} | {} | {} |", rule.code, rule.severity, rule.text);
            assert!(page.contains(&row), "docs/validate.md lacks the line\n{row}");
        }
    }
}
