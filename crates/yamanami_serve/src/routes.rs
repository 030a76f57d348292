//! Which address answers what, and what is refused before.

use crate::cache::Cache;
use crate::fault::Fault;
use crate::heights::{self, Line, Place};
use crate::limits::Limits;
use crate::pages::{self, Language};
use crate::reply::{self, AN_HOUR, ASK_AGAIN, Content, Finished, Reply};
use crate::surface::{Served, Surfaces};
use crate::tiles::{self, Tile};
use crate::viewer::{self, Viewer};
use crate::work::Work;
use crate::{pack, picture};
use axum::Router;
use axum::extract::{Path, Query, Request, State};
use axum::http::header::{self, HeaderMap};
use axum::http::{Method, StatusCode};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Redirect};
use axum::routing::get;
use futures_util::FutureExt;
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::panic::AssertUnwindSafe;
use std::sync::Arc;

/// What all answers draw from.
#[derive(Debug)]
pub(crate) struct App {
    pub(crate) surfaces: Surfaces,
    pub(crate) viewer: Viewer,
    pub(crate) work: Work,
    pub(crate) limits: Limits,
    pub(crate) cors: bool,
    /// Host and port where no `Host` header says better.
    pub(crate) host: String,
    pub(crate) tiles: Cache<TileKey>,
}

/// A tile of a surface, and of what kind.
pub(crate) type TileKey = (String, &'static str, Tile);

type Answer = Result<Reply, Fault>;
type Shared = State<Arc<App>>;

/// All routes. Those of other kinds of tiles go beside `terrain-rgb`.
pub(crate) fn router(app: Arc<App>) -> Router {
    Router::new()
        .route("/", get(list))
        .route("/view", get(|| async { Redirect::permanent("/view/") }))
        .route("/view/", get(viewer_page))
        .route("/view/site.json", get(site))
        .route("/view/{*file}", get(viewer_file))
        .route("/s/{name}/surface.pack", get(packed))
        .route("/s/{name}/info.json", get(info))
        .route("/s/{name}/picture.png", get(picture_png))
        .route("/s/{name}/height", get(height))
        .route("/s/{name}/profile", get(profile))
        .route("/s/{name}/terrain-rgb/tilejson.json", get(tilejson))
        .route("/s/{name}/terrain-rgb/{z}/{x}/{y}", get(terrain_rgb))
        .route("/s/{name}/quantized-mesh/layer.json", get(layer_json))
        .route("/s/{name}/quantized-mesh/{z}/{x}/{y}", get(quantized_mesh))
        .fallback(|| async { Fault::not_found("nothing is here") })
        .layer(from_fn_with_state(app.clone(), guard))
        .with_state(app)
}

impl IntoResponse for Fault {
    fn into_response(self) -> Reply {
        let mut reply = self.status.into_response();
        reply.extensions_mut().insert(self);
        reply
    }
}

/// Refuses what is not asked for properly; sees that every answer comes in time, that a panic is one failed request and
/// no more, and that faults are told in the asker's form.
async fn guard(State(app): Shared, request: Request, next: Next) -> Reply {
    let path = request.uri().path().to_owned();
    let wants_page = reply::text(request.headers(), header::ACCEPT).is_some_and(|kinds| kinds.contains("text/html"));
    let as_page = wants_page && !path.starts_with("/s/");
    let refused = refusal(&app, &request);
    let mut reply = match refused {
        Some(reply) => reply,
        None => {
            let answer = AssertUnwindSafe(next.run(request)).catch_unwind();
            match tokio::time::timeout(app.limits.request_time, answer).await {
                Ok(Ok(reply)) => reply,
                Ok(Err(_)) => Fault::internal().into_response(),
                Err(_) => Fault::new(StatusCode::SERVICE_UNAVAILABLE, "this took too long").into_response(),
            }
        }
    };
    let status = reply.status();
    if (status.is_client_error() || status.is_server_error()) && reply.extensions().get::<Finished>().is_none() {
        let own = reply.extensions_mut().remove::<Fault>();
        let fault = own.unwrap_or_else(|| Fault::new(status, status.canonical_reason().unwrap_or("refused")));
        reply = reply::of_fault(&fault, as_page);
    }
    if status == StatusCode::METHOD_NOT_ALLOWED {
        reply::put(&mut reply, header::ALLOW, "GET, HEAD");
    }
    if matches!(status, StatusCode::PAYLOAD_TOO_LARGE | StatusCode::METHOD_NOT_ALLOWED) {
        // a body that is not read would be taken for the next request
        reply::put(&mut reply, header::CONNECTION, "close");
    }
    reply::put(&mut reply, header::X_CONTENT_TYPE_OPTIONS, "nosniff");
    if app.cors {
        reply::put(&mut reply, header::ACCESS_CONTROL_ALLOW_ORIGIN, "*");
        let seen = "accept-ranges, content-length, content-range, etag";
        reply::put(&mut reply, header::ACCESS_CONTROL_EXPOSE_HEADERS, seen);
    }
    reply
}

/// What is answered instead of looking further.
fn refusal(app: &App, request: &Request) -> Option<Reply> {
    let (method, headers) = (request.method(), request.headers());
    if method == Method::OPTIONS && app.cors {
        let mut reply = StatusCode::NO_CONTENT.into_response();
        reply::put(&mut reply, header::ACCESS_CONTROL_ALLOW_METHODS, "GET, HEAD");
        reply::put(&mut reply, header::ACCESS_CONTROL_ALLOW_HEADERS, "range, if-range, if-none-match");
        reply::put(&mut reply, header::ACCESS_CONTROL_MAX_AGE, "86400");
        return Some(reply);
    }
    if method != Method::GET && method != Method::HEAD {
        let line = "only GET and HEAD are answered here";
        return Some(Fault::new(StatusCode::METHOD_NOT_ALLOWED, line).into_response());
    }
    let url_bytes = request.uri().path_and_query().map_or(0, |whole| whole.as_str().len());
    if url_bytes > app.limits.url_bytes {
        let line = format!("an address of {url_bytes} bytes; at most {} are read", app.limits.url_bytes);
        return Some(Fault::new(StatusCode::URI_TOO_LONG, line).into_response());
    }
    let has_body = headers.contains_key(header::TRANSFER_ENCODING)
        || headers.get(header::CONTENT_LENGTH).is_some_and(|length| length != "0");
    has_body.then(|| Fault::new(StatusCode::PAYLOAD_TOO_LARGE, "a request here has no body").into_response())
}

fn language(headers: &HeaderMap) -> Language {
    Language::of(reply::text(headers, header::ACCEPT_LANGUAGE).unwrap_or_default())
}

fn html(text: String, headers: &HeaderMap) -> Reply {
    let mut reply = Content::new("text/html; charset=utf-8", text, ASK_AGAIN).reply(headers);
    reply::put(&mut reply, header::VARY, "accept-language");
    reply
}

fn json_reply(value: &Value, headers: &HeaderMap) -> Reply {
    Content::new("application/json", value.to_string(), ASK_AGAIN).reply(headers)
}

async fn list(State(app): Shared, headers: HeaderMap) -> Reply {
    html(pages::list(&app.surfaces, language(&headers)), &headers)
}

async fn viewer_page(State(app): Shared, headers: HeaderMap) -> Answer {
    if app.viewer.is_empty() {
        let mut reply = html(pages::no_viewer(language(&headers)), &headers);
        *reply.status_mut() = StatusCode::NOT_FOUND;
        reply.headers_mut().remove(header::ETAG);
        reply.extensions_mut().insert(Finished);
        return Ok(reply);
    }
    app.viewer.reply("index.html", &headers)
}

async fn viewer_file(State(app): Shared, Path(file): Path<String>, headers: HeaderMap) -> Answer {
    app.viewer.reply(&file, &headers)
}

/// What the viewer's page shows: the same file as in a site of files.
async fn site(State(app): Shared, headers: HeaderMap) -> Reply {
    let surface = |served: &Arc<Served>| {
        let at = |file: &str| format!("../s/{}/{file}", served.name);
        crate::site::entry(served, &at("surface.pack"), &at("picture.png"))
    };
    let surfaces: Vec<Value> = app.surfaces.all.iter().map(surface).collect();
    json_reply(&json!({ "surfaces": surfaces }), &headers)
}

async fn packed(State(app): Shared, Path(name): Path<String>, method: Method, headers: HeaderMap) -> Answer {
    let served = app.surfaces.get(&name)?;
    served.check()?;
    pack::reply(&app.work, served, method == Method::HEAD, &headers).await
}

async fn info(State(app): Shared, Path(name): Path<String>, headers: HeaderMap) -> Answer {
    let served = app.surfaces.get(&name)?;
    served.check()?;
    Ok(json_reply(&served.info, &headers))
}

async fn picture_png(State(app): Shared, Path(name): Path<String>, headers: HeaderMap) -> Answer {
    let served = app.surfaces.get(&name)?.clone();
    let drawn = served.picture.get_or_try_init(|| {
        let served = served.clone();
        app.work.run(move || {
            served.check()?;
            picture::draw(&served)
        })
    });
    Ok(drawn.await?.clone().reply(&headers))
}

/// Works out an answer of a surface in JSON.
async fn worked_out(
    app: &App,
    name: &str,
    headers: &HeaderMap,
    job: impl FnOnce(&Served) -> Result<Value, Fault> + Send + 'static,
) -> Answer {
    let served = app.surfaces.get(name)?.clone();
    let found = app.work.run(move || {
        served.check()?;
        job(&served)
    });
    Ok(json_reply(&found.await?, headers))
}

async fn height(
    State(app): Shared,
    Path(name): Path<String>,
    headers: HeaderMap,
    Query(place): Query<Place>,
) -> Answer {
    worked_out(&app, &name, &headers, move |served| heights::height(served, &place)).await
}

async fn profile(State(app): Shared, Path(name): Path<String>, headers: HeaderMap, Query(line): Query<Line>) -> Answer {
    worked_out(&app, &name, &headers, move |served| heights::profile(served, &line)).await
}

#[derive(Debug, Deserialize)]
struct TileQuery {
    encoding: Option<String>,
}

async fn tilejson(
    State(app): Shared,
    Path(name): Path<String>,
    headers: HeaderMap,
    Query(query): Query<TileQuery>,
) -> Answer {
    let encoding = tiles::encoding(query.encoding.as_deref())?;
    let base = app.base(&headers);
    worked_out(&app, &name, &headers, move |served| tiles::tilejson(served, &base, encoding)).await
}

async fn terrain_rgb(
    State(app): Shared,
    Path(place): Path<HashMap<String, String>>,
    headers: HeaderMap,
    Query(query): Query<TileQuery>,
) -> Answer {
    let part = |key: &str| place.get(key).map(String::as_str).unwrap_or_default();
    let served = app.surfaces.get(part("name"))?.clone();
    served.check()?;
    let tile = tiles::parse(1, part("z"), part("x"), part("y"), ".png")?;
    let encoding = tiles::encoding(query.encoding.as_deref())?;
    let key = (served.name.clone(), encoding.name(), tile);
    let made = app.tile(key, move || tiles::height_png(&served, tile, encoding));
    Ok(Content::new("image/png", made.await?, AN_HOUR).reply(&headers))
}

async fn layer_json(State(app): Shared, Path(name): Path<String>, headers: HeaderMap) -> Answer {
    let served = app.surfaces.get(&name)?.clone();
    let text = app.work.run(move || {
        served.check()?;
        Ok(served.meshes()?.layer_json())
    });
    Ok(Content::new("application/json", text.await?, ASK_AGAIN).reply(&headers))
}

async fn quantized_mesh(State(app): Shared, Path(place): Path<HashMap<String, String>>, headers: HeaderMap) -> Answer {
    let part = |key: &str| place.get(key).map(String::as_str).unwrap_or_default();
    let served = app.surfaces.get(part("name"))?.clone();
    served.check()?;
    let tile = tiles::parse(2, part("z"), part("x"), part("y"), ".terrain")?;
    let key = (served.name.clone(), "quantized-mesh", tile);
    let packed = app.tile(key, move || tiles::mesh(&served, tile));
    let packed = packed.await?;
    let kind = "application/vnd.quantized-mesh";
    let mut reply;
    if viewer::accepts(reply::text(&headers, header::ACCEPT_ENCODING).unwrap_or_default(), "gzip") {
        reply = Content::new(kind, packed, AN_HOUR).reply(&headers);
        reply::put(&mut reply, header::CONTENT_ENCODING, "gzip");
    } else {
        reply = Content::new(kind, tiles::unpacked(&packed)?, AN_HOUR).reply(&headers);
    }
    reply::put(&mut reply, header::VARY, "accept-encoding");
    Ok(reply)
}

impl App {
    /// A tile from the cache, or as it is made.
    async fn tile(
        &self,
        key: TileKey,
        make: impl FnOnce() -> Result<Vec<u8>, Fault> + Send + 'static,
    ) -> Result<bytes::Bytes, Fault> {
        if let Some(bytes) = self.tiles.get(&key) {
            return Ok(bytes);
        }
        let made = bytes::Bytes::from(self.work.run(make).await?);
        self.tiles.put(key, made.clone());
        Ok(made)
    }

    /// Scheme and host as the asker knows them.
    fn base(&self, headers: &HeaderMap) -> String {
        let is_host = |c: char| c.is_ascii_alphanumeric() || ".-:[]".contains(c);
        let host = reply::text(headers, header::HOST).filter(|host| !host.is_empty() && host.chars().all(is_host));
        format!("http://{}", host.unwrap_or(&self.host))
    }
}
