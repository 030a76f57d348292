//! The demo's map: Kofu and the mountains around it, from bundled data that stay in the folder to be tried again.

use super::map::{Written, write_map};
use super::{Command, Program};
use crate::failure::Failure;
use crate::{inputs, out, text};
use clap::Parser;
use std::path::Path;

const FILES: [(&str, &[u8]); 3] = [
    ("central_japan_srtm30.tif", include_bytes!("../../data/central_japan_srtm30.tif")),
    ("fuji_terrainrgb_z10_x906_y404.png", include_bytes!("../../data/fuji_terrainrgb_z10_x906_y404.png")),
    ("japan_mountains.csv", include_bytes!("../../data/japan_mountains.csv")),
];
/// The map of the demo and of the front page.
const KOFU: &str = "--at 35.66,138.57 --radius 110 --ring 30 --eye 9000 --exaggeration 1.8 --title 甲府盆地と山並み";
const CREDIT: &str =
    "標高: SRTM30 (NASA / USGS)、富士山は MARTINI 付属の標高タイル。山名: 国土地理院「日本の主な山岳標高」";

/// Leaves the data in a folder, the map beside it, and a line about it.
pub(super) fn run(folder: &Path) -> Result<(), Failure> {
    let data = folder.join("map-data");
    inputs::make_folder(&data)?;
    for (name, bytes) in FILES {
        out::file(&data.join(name), bytes)?;
    }
    let map = folder.join("map.png");
    let [wide, fine, names] = FILES.map(|(name, _)| data.join(name));
    let files = [wide.as_path(), &fine, Path::new("--places"), &names, Path::new("-o"), &map];
    let words = ["yamanami", "map"].into_iter().map(Into::into);
    let credit = ["--credit", CREDIT].into_iter().map(Into::into);
    let words =
        words.chain(files.map(|f| f.as_os_str().to_owned())).chain(KOFU.split(' ').map(Into::into)).chain(credit);
    let Ok(Program { command: Command::Map(args) }) = Program::try_parse_from(words) else { return Ok(()) };
    let Written { full_triangles, made, .. } = write_map(&args)?;
    out::row(
        "map.png",
        format_args!(
            "Kofu and its mountains, {} of {} triangles, error at most {} px",
            text::count(made.triangles as u64),
            text::count(full_triangles),
            text::number(f64::from(made.error_px.unwrap_or_default()))
        ),
    )
}
