// Which method "Automatic" took, and why: the server tells it with a picture, and it holds for the cloud as it is.

const find = (id) => document.getElementById(id);

export class ChosenMethod {
  #of = '';
  #method;
  #reason = '';
  #titles = new Map();

  setMethods(methods) {
    this.#titles = new Map(methods.map(({ name, title }) => [name, title || name]));
  }

  /** `stats` of a picture of that cloud; where a method was named, they give no reason. */
  told({ method, methodReason }, cloud) {
    if (!method || !methodReason || !cloud) return;
    this.#of = `${cloud.id} ${cloud.revision}`;
    this.#method = method;
    this.#reason = methodReason;
  }

  #isKnown(view, cloud) {
    return view.method === 'auto' && cloud !== undefined && this.#of === `${cloud.id} ${cloud.revision}`;
  }

  /** "Paraboloids (automatic)", or the name of the method that the view asks for. */
  words(view, cloud) {
    const title = (name) => this.#titles.get(name) ?? name;
    return this.#isKnown(view, cloud) ? `${title(this.#method)} (automatic)` : (title(view.method) ?? '');
  }

  /** Says it in the panel. */
  show(view, cloud) {
    const known = this.#isKnown(view, cloud);
    const title = this.#titles.get(this.#method) ?? this.#method;
    const option = find('method').querySelector('option[value=auto]');
    const automatic = this.#titles.get('auto') ?? 'Automatic';
    const label = known ? `${automatic} (${title})` : automatic;
    if (option && option.textContent !== label) option.textContent = label;
    const reason = this.#reason.charAt(0).toUpperCase() + this.#reason.slice(1);
    const words = known ? `Chosen for this cloud: ${title}. ${reason}.` : '';
    if (find('method-chosen').textContent !== words) find('method-chosen').textContent = words;
  }
}
