"""The part "Configuration", by clicking and typing."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from hostlib.daemon import BIN
from playwright.sync_api import Browser, Locator, Page, WebSocketRoute, expect

from conftest import PATIENCE_MS, Studio

MODIFIER = "Control"


@pytest.fixture
def editor(page: Page) -> Locator:
    """The text of the running robot in the editor."""
    page.locator("#tab-configuration").click()
    text = page.get_by_label("Text of the configuration")
    expect(text).to_contain_text("robot: host")
    return text


def verdict(page: Page) -> Locator:
    return page.locator(".verdict-badge")


def problems(page: Page) -> Locator:
    return page.get_by_role("region", name="Messages of rc10d --check")


def paste_over_all(page: Page, editor: Locator, text: str) -> None:
    """Pastes as a person does."""
    editor.focus()
    page.keyboard.press(f"{MODIFIER}+A")
    editor.evaluate(
        """(element, text) => {
          const data = new DataTransfer();
          data.setData('text/plain', text);
          element.dispatchEvent(
            new ClipboardEvent('paste', { clipboardData: data, bubbles: true, cancelable: true }));
        }""",
        text,
    )


def downloaded(page: Page) -> str:
    with page.expect_download() as saved:
        page.get_by_role("button", name="Download").click()
    return Path(saved.value.path()).read_text()


def test_the_file_that_runs_is_there_with_its_ids_load_and_ends(
    page: Page, studio: Studio, editor: Locator
) -> None:
    expect(editor).to_be_visible()
    expect(page.get_by_text("the file that runs")).to_be_visible()
    expect(verdict(page)).to_contain_text("rc10d accepts it")
    chassis = page.get_by_role("region", name="chassis")
    expect(chassis).to_contain_text("simulated")
    expect(chassis).to_contain_text(re.compile(r"\d+\.\d % . \d+\.\d %"))
    wheel = chassis.get_by_role("row", name=re.compile("^wheel"))
    for words in ("M3508", "0x200 slot 1", "0x201 at 1000 Hz", "coast"):
        expect(wheel).to_contain_text(words)
    assert downloaded(page) == studio.daemon.config.read_text()


def test_while_typing_messages_come_at_their_lines_and_the_load_is_drawn_anew(
    page: Page, editor: Locator
) -> None:
    chassis = page.get_by_role("region", name="chassis")
    expect(chassis.get_by_role("row", name=re.compile("^other"))).to_contain_text("slot 2")
    load = chassis.locator("strong").inner_text()
    # The id of "other", which is the one of "wheel" now.
    page.locator(".cm-line", has_text="name: other").click()
    page.keyboard.press("End")
    for _ in range(2):
        page.keyboard.press("ArrowLeft")
    page.keyboard.press("Shift+ArrowRight")
    page.keyboard.type("1")
    expect(verdict(page)).to_contain_text("errors: 1")
    expect(page.get_by_text("changed", exact=True)).to_be_visible()
    message = problems(page).get_by_role("listitem")
    expect(message).to_contain_text("buses[0].motors[1].id")
    expect(page.locator(".cm-lint-marker-error")).to_have_count(1)
    expect(page.get_by_text("Of the last text without errors.")).to_be_visible()
    place = message.get_by_role("button")
    line = int(place.inner_text().split(":")[0])
    # Its button leads to the line, also by the keyboard.
    page.keyboard.press(f"{MODIFIER}+Home")
    place.press("Enter")
    expect(editor).to_be_focused()
    expect(page.locator(".cm-activeLine")).to_contain_text("name: other")
    assert page.locator(".cm-line").nth(line - 1).inner_text().strip().startswith("- {name: other")
    page.keyboard.press("End")
    for _ in range(2):
        page.keyboard.press("ArrowLeft")
    page.keyboard.press("Shift+ArrowRight")
    page.keyboard.type("3, on_estop: damp")
    expect(verdict(page)).to_contain_text("rc10d accepts it")
    other = chassis.get_by_role("row", name=re.compile("^other"))
    expect(other).to_contain_text("slot 3")
    expect(other).to_contain_text("damp")
    # A third motor on that bus.
    page.keyboard.press("End")
    page.keyboard.press("Enter")
    page.keyboard.type("- {name: third, profile: m3508, id: 7}")
    expect(chassis.get_by_role("row", name=re.compile("^third"))).to_contain_text("0x1FF slot 3")
    expect(chassis.locator("strong")).not_to_have_text(load)
    expect(problems(page)).to_have_count(0)


def test_the_key_at_the_cursor_is_explained_and_keys_are_suggested(
    page: Page, editor: Locator
) -> None:
    help_card = page.get_by_role("region", name="Key at the cursor")
    page.locator(".cm-line", has_text="name: yaw").click()
    page.keyboard.press("End")
    page.keyboard.press("ArrowLeft")
    expect(help_card).to_contain_text("id")
    # The range of this model, which stands in its profile.
    expect(help_card).to_contain_text("values: 1 … 7")
    page.keyboard.type(", current_lim")
    suggestion = page.get_by_role("option", name="current_limit_a")
    expect(suggestion).to_be_visible()
    # A key that is pressed sooner is meant for the text: the editor's own guard.
    page.evaluate("new Promise((done) => setTimeout(done, 150))")
    page.keyboard.press("Enter")
    expect(page.locator(".cm-line", has_text="name: yaw")).to_contain_text("current_limit_a: }")
    expect(help_card).to_contain_text("Unit: A.")
    page.keyboard.type("1")
    page.keyboard.press("End")
    page.keyboard.press("ArrowLeft")
    page.keyboard.type(", on_estop: ")
    page.keyboard.press("Control+Space")
    expect(page.get_by_role("option")).to_have_text(["coast", "damp", "brake", "hold", "ramp"])
    page.keyboard.press("Escape")
    # Tab leaves the editor: nobody is caught in it.
    page.keyboard.press("Tab")
    expect(editor).not_to_be_focused()


def test_a_template_and_files_from_elsewhere_are_edited_undone_and_downloaded(
    page: Page, studio: Studio, editor: Locator, tmp_path: Path
) -> None:
    page.get_by_role("button", name="Template").click()
    expect(editor).to_contain_text("robot: my_robot")
    expect(verdict(page)).to_have_text("rc10d accepts it")
    printed = subprocess.run([BIN / "rc10d", "--init"], capture_output=True, text=True, check=True)
    assert downloaded(page) == printed.stdout
    file = tmp_path / "sentry.yaml"
    file.write_text(studio.daemon.config.read_text().replace("robot: host", "robot: sentry"))
    page.locator("input[type=file]").set_input_files(file)
    expect(editor).to_contain_text("robot: sentry")
    expect(page.get_by_text("sentry.yaml")).to_be_visible()
    expect(page.get_by_role("heading", name="Buses: sentry")).to_be_visible()
    # A file that is dropped takes its place; so much can be undone.
    page.evaluate(
        """() => {
          const data = new DataTransfer();
          data.items.add(new File(['robot: dropped\\n'], 'd.yaml'));
          document.querySelector('.config').dispatchEvent(
            new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));
        }"""
    )
    expect(editor).to_contain_text("robot: dropped")
    expect(problems(page)).to_contain_text("buses")
    editor.click()
    page.keyboard.press(f"{MODIFIER}+Z")
    expect(editor).to_contain_text("robot: sentry")
    # Another part of the page and back: the text is still there.
    page.locator("#tab-events").click()
    page.locator("#tab-configuration").click()
    expect(editor).to_contain_text("robot: sentry")
    page.get_by_role("button", name=re.compile("^The robot.s file")).click()
    expect(editor).to_contain_text("robot: host")


def test_the_file_with_which_rc10d_refused_to_start_is_there_to_be_mended(
    page: Page, studio: Studio
) -> None:
    studio.daemon.kill()
    sound = studio.daemon.config.read_text()
    studio.daemon.config.write_text(sound.replace("model: GM6020", "model: GM6O20"))
    studio.daemon.start()
    assert studio.daemon.program.wait() == 2
    expect(page.get_by_label("It refused to start")).to_contain_text("GM6O20")
    page.locator("#tab-configuration").click()
    expect(page.get_by_text("the file with which rc10d refused to start")).to_be_visible()
    expect(problems(page)).to_contain_text("did you mean GM6020?")
    page.locator(".cm-line", has_text="GM6O20").click()
    page.keyboard.press("Home")
    page.keyboard.press("Shift+End")
    page.keyboard.insert_text("gm6020: {model: GM6020, feedback_timeout_ms: 1000}")
    expect(verdict(page)).to_contain_text("rc10d accepts it")
    # As it was downloaded it runs.
    studio.daemon.config.write_text(downloaded(page))
    studio.daemon.start()
    studio.daemon.wait_ready()


def test_hostile_texts_get_a_message_and_the_page_and_its_stop_go_on(
    page: Page, studio: Studio, editor: Locator
) -> None:
    bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n"
    for i in range(1, 10):
        bomb += f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]\n"
    paste_over_all(page, editor, bomb)
    expect(problems(page)).to_contain_text("more than 20000 values")
    paste_over_all(page, editor, "[" * 20_000)
    expect(problems(page)).to_contain_text("nested more than 16 deep")
    paste_over_all(page, editor, "x: 1\n" * 30_000)
    expect(page.get_by_text("A page checks at most 128 KiB.")).to_be_visible()
    paste_over_all(page, editor, "<script>alert(1)</script>: '</style>'\n")
    expect(problems(page)).to_contain_text("<script>")
    page.get_by_role("button", name="STOP").click()
    studio.daemon.wait_state(lambda state: state["state"] == "ESTOP", "it is stopped")
    expect(page.locator(".stop-told")).to_have_text("stopped: confirmed")


def test_on_a_phone_in_chinese_it_is_read_and_typed(chromium: Browser, studio: Studio) -> None:
    context = chromium.new_context(
        viewport={"width": 390, "height": 844}, locale="zh-CN", has_touch=True, is_mobile=True
    )
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    page.goto(studio.url)
    page.locator("#tab-configuration").tap()
    editor = page.get_by_label("配置文件的文字")
    expect(editor).to_contain_text("robot: host")
    expect(verdict(page)).to_contain_text("rc10d 接受")
    editor.tap()
    page.keyboard.press(f"{MODIFIER}+Home")
    page.keyboard.type("oops: 1\n")
    message = page.get_by_role("region", name="rc10d --check 的消息").get_by_role("listitem")
    expect(message).to_contain_text("unknown key")
    expect(message.get_by_role("button")).to_have_text("1:1")
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    context.close()


def test_a_check_whose_connection_was_lost_is_asked_again(
    page: Page, studio: Studio, editor: Locator
) -> None:
    expect(verdict(page)).to_contain_text("rc10d accepts it")
    studio.web.stop()
    expect(page.locator(".badge.connection")).to_have_text("no connection to rc10-web")
    paste_over_all(page, editor, "robot: host\nbuses: []\nwheels: 4\n")
    expect(page.get_by_text("no connection", exact=True)).to_be_visible()
    expect(verdict(page)).to_have_text("not checked")
    studio.start(studio.port)
    expect(verdict(page)).to_contain_text("errors:")
    expect(page.get_by_text("no connection", exact=True)).to_have_count(0)


def test_an_answer_for_a_text_that_was_emptied_meanwhile_is_not_shown(page: Page) -> None:
    late: list[str | bytes] = []

    def relay(socket: WebSocketRoute) -> None:
        server = socket.connect_to_server()
        server.on_message(
            lambda message: (
                late.append(message) if "config_checked" in str(message) else socket.send(message)
            )
        )

        def release(message: str | bytes) -> None:
            server.send(message)
            # The page beats twice a second.
            if late and "emptied" in state:
                socket.send(late.pop())
                state.append("released")

        socket.on_message(release)

    state: list[str] = []
    page.route_web_socket("**/link", relay)
    page.reload()
    page.locator("#tab-configuration").click()
    editor = page.get_by_label("Text of the configuration")
    expect(editor).to_contain_text("robot: host")
    expect(verdict(page)).to_have_text("checking…")
    while not late:
        page.wait_for_timeout(50)
    editor.focus()
    page.keyboard.press(f"{MODIFIER}+A")
    page.keyboard.press("Delete")
    expect(verdict(page)).to_have_text("not checked")
    state.append("emptied")
    while "released" not in state:
        page.wait_for_timeout(50)
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")
    expect(verdict(page)).to_have_text("not checked")
    expect(page.get_by_role("region", name="chassis")).to_have_count(0)


@pytest.mark.parametrize(
    ("answer", "why"),
    [
        ("Promise.reject(new TypeError('no network'))", "no network"),
        ("Promise.resolve(new Response('no such file', {status: 404}))", "404"),
    ],
)
def test_a_template_that_cannot_be_had_is_told_and_the_text_stays(
    page: Page, editor: Locator, answer: str, why: str
) -> None:
    page.evaluate(f"() => {{ window.fetch = () => {answer}; }}")
    page.get_by_role("button", name="Template", exact=True).click()
    alert = page.get_by_role("alert")
    expect(alert).to_contain_text("The template could not be loaded:")
    expect(alert).to_contain_text(why)
    expect(editor).to_contain_text("robot: host")


def test_a_schema_that_could_not_be_had_is_asked_for_again(page: Page) -> None:
    page.evaluate("""() => {
      const { fetch } = window;
      window.asked = 0;
      window.fetch = (path) => {
        if (path !== '/rc10d.schema.json' || ++window.asked > 1) return fetch(path);
        return Promise.reject(new TypeError('no network'));
      };
    }""")
    for _ in range(2):
        page.locator("#tab-configuration").click()
        expect(page.get_by_label("Text of the configuration")).to_contain_text("robot: host")
        page.locator("#tab-overview").click()
    page.locator("#tab-configuration").click()
    page.locator(".cm-line", has_text="name: yaw").click()
    page.keyboard.press("End")
    page.keyboard.press("ArrowLeft")
    expect(page.get_by_role("region", name="Key at the cursor")).to_contain_text("values: 1 … 7")
    assert page.evaluate("window.asked") == 2
