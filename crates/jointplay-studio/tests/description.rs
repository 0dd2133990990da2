//! The OpenAPI description that is served is that of the types.

#[test]
fn the_description_served_is_that_of_the_types() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/openapi.json");
    let described = jointplay_studio::description();
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        std::fs::write(file, &described).unwrap();
    }
    let kept = std::fs::read_to_string(file).unwrap_or_default();
    // Not `assert_eq!`, which would print both documents completely.
    assert!(
        kept == described,
        "openapi.json differs from the types of the server; rewrite it by\n  INSTA_UPDATE=always cargo test -p jointplay-studio --test description\nand the page's types by `npm run types` in studio"
    );
}
