//! The OpenAPI description that is checked in is the one that is served.

#[test]
fn the_description_checked_in_is_the_one_served() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../studio/openapi.json");
    let served = jointplay_studio::description();
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        std::fs::write(file, &served).unwrap();
    }
    let kept = std::fs::read_to_string(file).unwrap_or_default();
    // Not `assert_eq!`, which would print both documents completely.
    assert!(
        kept == served,
        "studio/openapi.json differs from the description of the server; rewrite it by\n  INSTA_UPDATE=always cargo test -p jointplay-studio --test description\nand the page's types by `npm run types` in studio"
    );
}
