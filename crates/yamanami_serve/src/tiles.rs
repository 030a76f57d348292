//! Map tiles on demand: heights as colours (Terrain-RGB, Terrarium, GSI), and the TileJSON that describes them.

use crate::fault::Fault;
use crate::surface::{Served, TILE_PX};
use serde_json::{Value, json};
use std::io::Read;
use yamanami::MOST_ZOOM;
use yamanami::io::dem::TileEncoding;
use yamanami::io::tiles::encode_height_png;

/// A tile by zoom, column, row.
pub(crate) type Tile = [u32; 3];

/// The tile of a path's last parts, the row with its ending. Columns are as many times 2^zoom as there are root tiles.
pub(crate) fn parse(roots: u32, zoom: &str, x: &str, y: &str, ending: &str) -> Result<Tile, Fault> {
    let number = |text: &str| text.parse::<u32>().ok().filter(|_| text.bytes().all(|b| b.is_ascii_digit()));
    let tile = number(zoom).zip(number(x)).zip(y.strip_suffix(ending).and_then(number));
    let tile = tile.map(|((zoom, x), y)| [zoom, x, y]);
    tile.filter(|&[zoom, x, y]| zoom <= MOST_ZOOM && x < roots << zoom && y < 1 << zoom)
        .ok_or_else(|| Fault::not_found("there is no such tile"))
}

/// An encoding by the name that queries have.
pub(crate) fn encoding(name: Option<&str>) -> Result<TileEncoding, Fault> {
    match name {
        None | Some("terrain-rgb" | "mapbox") => Ok(TileEncoding::TerrainRgb),
        Some("terrarium") => Ok(TileEncoding::Terrarium),
        Some("gsi") => Ok(TileEncoding::Gsi),
        Some(_) => Err(Fault::bad("encoding: expected terrain-rgb, terrarium or gsi")),
    }
}

/// A tile as PNG; a fault where there is no ground.
pub(crate) fn height_png(served: &Served, [zoom, x, y]: Tile, encoding: TileEncoding) -> Result<Vec<u8>, Fault> {
    let found = served.tiles()?.heights_m(zoom, x, y).map_err(|e| served.unreadable(e))?;
    let heights_m = found.ok_or_else(|| Fault::not_found("there is no ground in this tile"))?;
    Ok(encode_height_png(encoding, &heights_m, TILE_PX))
}

/// A quantized-mesh tile, packed with gzip; rows count from the south.
pub(crate) fn mesh(served: &Served, [zoom, x, y]: Tile) -> Result<Vec<u8>, Fault> {
    let made = served.meshes()?.tile(zoom, x, y).map_err(|e| served.unreadable(e))?;
    made.ok_or_else(|| Fault::not_found("there is no such tile"))
}

/// A tile that was packed, for who takes nothing packed.
pub(crate) fn unpacked(bytes: &[u8]) -> Result<Vec<u8>, Fault> {
    let mut plain = Vec::new();
    flate2::read::GzDecoder::new(bytes).read_to_end(&mut plain).map_err(|_| Fault::internal())?;
    Ok(plain)
}

/// TileJSON 3.0 with absolute addresses; `base` is scheme and host.
pub(crate) fn tilejson(served: &Served, base: &str, encoding: TileEncoding) -> Result<Value, Fault> {
    let tiles = served.tiles()?;
    let [west, south, east, north] = tiles.bounds_deg();
    let (name, query) = match encoding {
        TileEncoding::Terrarium => ("terrarium", "?encoding=terrarium"),
        TileEncoding::Gsi => ("gsi", "?encoding=gsi"),
        _ => ("mapbox", ""),
    };
    Ok(json!({
        "tilejson": "3.0.0",
        "name": served.title,
        "tiles": [format!("{base}/s/{}/terrain-rgb/{{z}}/{{x}}/{{y}}.png{query}", served.name)],
        "minzoom": 0,
        "maxzoom": tiles.full_zoom(),
        "bounds": [west, south, east.min(180.0), north],
        "tileSize": TILE_PX,
        "encoding": name,
        "type": "raster-dem",
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_that_cannot_be_are_not_found() {
        assert_eq!(parse(1, "3", "7", "0.png", ".png"), Ok([3, 7, 0]));
        for (zoom, x, y) in [
            ("3", "8", "0.png"),
            ("3", "7", "0"),
            ("-1", "0", "0.png"),
            ("99", "0", "0.png"),
            ("+3", "0", "0.png"),
            ("3", "", "0.png"),
        ] {
            assert!(parse(1, zoom, x, y, ".png").is_err(), "{zoom}/{x}/{y}");
        }
    }
}
