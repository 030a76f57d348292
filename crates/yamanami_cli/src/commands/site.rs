//! `export --to site`: the browser viewer and its data as static files.

use super::export::ExportArgs;
use super::serve::{surfaces, viewer};
use crate::failure::Failure;
use crate::progress::{Bar, note};
use crate::{databases, out, text};
use serde_json::json;
use yamanami_serve::write_site;

pub(crate) fn run(args: &ExportArgs) -> Result<(), Failure> {
    let viewer = viewer(args.web.as_deref())?;
    let databases = databases::of(&args.source)?;
    let surfaces = surfaces(&databases)?;
    let report = {
        let bar = Bar::shares("exporting");
        write_site(&surfaces, &viewer, &args.output, &|share| bar.set_share(share))?
    };
    if args.json {
        return out::json(&json!({ "output": args.output, "files": report.files, "bytes": report.bytes }));
    }
    out::row(
        "written",
        format_args!("{}, {} files, {}", args.output.display(), text::count(report.files), text::bytes(report.bytes)),
    )?;
    note("next: put the folder on any web host, or look at it with: python3 -m http.server -d FOLDER");
    Ok(())
}
