// How a page begins: with the data in it, or with the reason why that cannot be shown.
import { byId } from './dom';

/// Calls `open`, keeps what it makes under `name`, for tests, and takes the message in the view away when the first
/// picture is there. If that fails, the message in the view names the
/// `subject` that cannot be shown, with an advice.
export async function openPage(
  name: string,
  subject: string,
  advice: string,
  open: () => Promise<{ firstPicture: Promise<void> }>,
): Promise<void> {
  const message = byId('message');
  const fail = (text: string) => {
    message.textContent = `${text} ${advice}`;
    byId('view').classList.add('failed');
  };
  if (typeof DecompressionStream === 'undefined') {
    fail(
      `This browser is too old to show the ${subject}: it cannot unpack the data. Chrome 103, Firefox 113 and Safari 16.4 can.`,
    );
    return;
  }
  try {
    const page = await open();
    Object.assign(window, { [name]: page });
    message.textContent = 'Drawing…';
    await page.firstPicture;
    message.remove();
    document.documentElement.dataset.ready = '';
  } catch (error) {
    fail(`The ${subject} cannot be shown (${error instanceof Error ? error.message : String(error)}).`);
  }
}
