// Every word that the page itself says, in one place, so that they can be read aloud one after the other, and translated. Words
// for what the server names (methods, attributes, stages) come from the server; here is only what a person calls them.
//
// What a tool says that is loaded when it is first used stands in strings/, and comes with it.
//
// index.html holds no words but its title: an element with data-text="panel.title" gets that string as its text; data-label,
// data-tip and data-hint are its aria-label, title and placeholder.

/** 1234567 → "1.2 million". Pure. */
export function amount(value) {
  if (!Number.isFinite(value)) return '–';
  for (const { size, word } of [{ size: 1e9, word: 'billion' }, { size: 1e6, word: 'million' }]) {
    if (value >= size) return `${(value / size).toPrecision(value >= 100 * size ? 3 : 2)} ${word}`;
  }
  return Math.round(value).toLocaleString('en');
}

/** "1 point", "1.2 million points". Pure. */
export const counted = (count, one, many = `${one}s`) => `${amount(count)} ${count === 1 ? one : many}`;

export const strings = {
  app: {
    name: 'Scancast',
    pointCloud: 'Point cloud',
    pointCloudNamed: (title) => `Point cloud: ${title}`,
    titled: (title) => `${title} · Scancast`,
    points: (count) => counted(count, 'point'),
    pointsSoFar: (count) => `${counted(count, 'point')} so far`,
  },

  actions: {
    label: 'Share and settings',
    undo: 'Undo: previous view',
    undoTip: 'Previous view (Ctrl+Z)',
    redo: 'Redo: next view',
    redoTip: 'Next view (Ctrl+Shift+Z)',
    copyLink: 'Copy link',
    copyLinkTip: 'Copy a link to this view',
    help: 'Help',
    helpTip: 'Mouse, touch and keyboard (?)',
    settings: 'Settings',
    settingsTip: 'Settings (P)',
  },

  tools: {
    label: 'Tools',
    orbit: 'Orbit',
    orbitTip: 'Orbit: drag to turn the scan (L switches)',
    look: 'Look',
    lookTip: 'Look around: drag to turn your head (L switches)',
    measure: 'Measure',
    measureTip: 'Measure: distances, heights, angles, areas, circles (M)',
    filter: 'Filter',
    filterTip: 'Filter by values: intensity, GPS time, returns … (B)',
    clip: 'Cut',
    clipTip: 'Cut the scan by boxes and half-spaces (X)',
    profile: 'Profile',
    profileTip: 'Profile along a line (T)',
    views: 'Views',
    annotate: 'Notes',
    annotateTip: 'Notes at points of the scan (I)',
    viewsTip: 'Suggested and saved views of this scan (V); J plays a tour',
    together: 'Together',
    togetherTip: 'Show other clouds with this one: neighbours, epochs (U)',
    compare: 'Compare',
    compareTip: 'Compare two methods, colourings or clouds (K)',
    picture: 'Picture',
    pictureTip: 'Save this view as a picture, of any size',
    export: 'Export',
    exportTip: 'Export points, elevation and orthophoto; addresses for maps',
    present: 'Present',
    presentTip: 'Presentation mode: the picture and nothing else (H)',
    notLoaded: 'This tool could not be loaded',
    notLoadedDetail: 'Check the connection, and press it again. If the server has been updated meanwhile, reload the page.',
  },

  views: {
    label: 'Standard views',
    fit: 'Fit',
    fitTip: 'Fit everything (F)',
    top: 'Top',
    topTip: 'View from the top (1)',
    front: 'Front',
    frontTip: 'View from the front (2)',
    side: 'Side',
    sideTip: 'View from the side (3)',
    orthographic: 'Orthographic',
    orthographicTip: 'Orthographic projection: no perspective, equal lengths look equal (O)',
    gallery: 'Suggested views',
    close: 'Close',
    none: 'No views are suggested for this scan.',
  },

  panel: {
    label: 'Settings',
    close: 'Close settings',
    resize: 'Change the height of the settings',
    cloud: 'Point cloud',
    loading: (title) => `${title} (loading…)`,
    failed: (title) => `${title} (could not be loaded)`,
    stations: 'Scan positions',
    stationPhotos: 'Photos taken here',
    photos: 'Photos',
    photosTip: 'Photos that came with the scan',
    upAxis: 'Up axis',
    upZ: 'Z (surveys)',
    upY: 'Y (models)',
    upMinusY: '−Y (depth cameras)',
    background: 'Background',
    backgroundColour: 'Background colour',
    detail: 'Detail',
    detailAutomatic: 'Automatic',
    detailVeryFine: 'Very fine (slower)',
    detailFine: 'Fine',
    detailMedium: 'Medium',
    detailCoarse: 'Coarse (faster)',
    detailPixels: (pixels) => `${pixels} px`,
    view: 'View',
    collides: 'Stop at surfaces when walking',
    theme: 'Theme',
    reset: 'Reset to defaults',
    about: 'About this scan',
  },

  appearance: {
    title: 'Appearance',
    sharp: 'Sharp',
    smooth: 'Smooth',
    raw: 'Raw',
    allMethods: 'All methods',
    tuning: 'Fine-tuning',
    chosen: (method, reason) => `Chosen for this scan: ${method}. ${reason}.`,
    automatic: (method) => `${method} (automatic)`,
    automaticIs: (automatic, method) => `${automatic} (${method})`,
    needs: (what) => `needs ${what}`,
    notOffered: 'not offered by this server',
    sharpNote: 'Crisp textures and edges.',
    smoothNote: 'Continuous surfaces: neighbouring points are blended.',
    rawNote: 'Every point as it was measured, one pixel each.',
    attributes: {
      surfels: 'surface normals', rgb: 'colours', cir: 'infrared', intensity: 'intensity', classification: 'classification', normal: 'normals',
      curvature: 'curvature',
    },
  },

  colour: {
    title: 'Colour',
    names: {
      auto: 'Automatic', rgb: 'RGB', cir: 'Infrared', intensity: 'Intensity', elevation: 'Elevation', classification: 'Classification',
      normal: 'Normals', curvature: 'Curvature', depth: 'Depth', lod: 'Level of detail', visibility: 'Hidden points', flat: 'Single colour', cloud: 'By cloud',
    },
    single: 'Single colour',
    ramp: 'Colour ramp',
    rampNames: { viridis: 'Viridis', turbo: 'Turbo', grey: 'Greyscale' },
    low: 'Minimum value',
    high: 'Maximum value',
    lowHint: 'min',
    highHint: 'max',
    notInScan: 'not in this scan',
    notInScanAre: (names) => `Not in this scan: ${names}.`,
    onlyTogether: 'only of clouds that are shown together',
    onlyReconstructed: 'only with the method “Reconstructed surface”',
    hiddenPoints: 'Hidden points are shown by the method “Reconstructed surface” only.',
    byIntensity: 'Shade by intensity',
  },

  /** What scans keep beside what is drawn, and in what; others are called what the file calls them. */
  columns: {
    names: {
      intensity: 'Intensity', classification: 'Classification', gps_time: 'GPS time', return_number: 'Return number', number_of_returns: 'Number of returns', scan_angle: 'Scan angle',
      point_source_id: 'Point source', user_data: 'User data', scan_direction: 'Scan direction', edge_of_flight_line: 'Edge of flight line', scanner_channel: 'Scanner channel',
      scan_number: 'Scan', distance: 'Distance', nir: 'Near infrared',
    },
    units: { gps_time: 's', scan_angle: '°' },
  },

  lighting: {
    title: 'Lighting',
    automatic: 'Automatic',
    names: { unlit: 'Unlit', phong: 'Headlight', eyedome: 'Eye-dome lighting' },
    mirrors: 'Show reflections in mirrors',
    behindMirrors: 'Show points recorded behind mirrors',
  },

  background: { dusk: 'Dusk', daylight: 'Daylight', black: 'Black', white: 'White', custom: 'Custom colour' },

  theme: { system: 'System', light: 'Light', dark: 'Dark' },

  /** [what to do, what it does] */
  hint: {
    mouse: (looks) => [['Drag', looks ? 'to look around' : 'to orbit'], ['right-drag', 'to pan'], ['scroll', 'to zoom'], ['double-click', 'to go there'], ['?', 'for help']],
    touch: (looks) => [['One finger', looks ? 'to look around' : 'to orbit'], ['two', 'to pan, zoom and turn'], ['double-tap', 'to go there']],
  },

  /** The line in the corner, and the figures behind it. */
  hud: {
    tip: 'State of the picture',
    states: { connecting: 'Connecting…', moving: 'Moving', refining: 'Refining', sharp: 'Sharp', waiting: 'Waiting', lost: 'Connection lost' },
    damage: 'Parts of this point cloud cannot be read; coarser points are shown in their place.',
    away: 'Part of the server is away: the picture is coarser until it is back.',
    fps: (count) => `${count} fps`,
    sample: 'sample',
    samples: 'samples',
    frameRate: 'Frame rate',
    latency: 'Latency',
    movingFrames: 'Moving frames',
    codecs: { jpeg: 'JPEG', h264: 'Video (H.264)' },
    videoFailed: 'JPEG: this browser could not show the video',
    resolution: 'Resolution',
    rendering: 'Rendering',
    encoding: 'Encoding',
    frameSize: 'Frame size',
    method: 'Method',
    samplesDrawn: 'Samples drawn',
    pointsShown: 'Scan points shown',
    detail: 'Detail',
    quality: 'JPEG quality',
    network: 'Network',
  },

  help: {
    title: 'Getting around',
    close: 'Close',
    note: 'While you move, the picture may be coarser; it sharpens within moments once you stop.',
    drag: 'Drag',
    dragDoes: 'orbit about the point under the cursor',
    rightDrag: 'Right-drag',
    rightDragDoes: 'pan; the point stays under the cursor (also Shift-drag)',
    wheel: 'Wheel',
    wheelDoes: 'zoom towards the point under the cursor, stopping before it',
    doubleClick: 'Double-click',
    doubleClickDoes: 'go there (with Shift: away from there)',
    oneFinger: 'One finger',
    oneFingerDoes: 'orbit',
    twoFingers: 'Two fingers',
    twoFingersDo: 'pan, pinch to zoom, twist to turn',
    threeFingers: 'Three fingers',
    threeFingersDo: 'look around',
    pen: 'Pen',
    penDoes: 'like the mouse; hold its button to pan',
    touchPad: 'Touchpad',
    touchPadDoes: 'scroll or pinch to zoom, scroll sideways to pan',
  },

  presentation: {
    leave: 'Leave presentation mode',
  },

  photos: {
    many: (count) => `${count.toLocaleString('en')} ${count === 1 ? 'photo' : 'photos'}`,
    button: (count) => `Photos (${count.toLocaleString('en')})`,
    count: (number, all) => `${number.toLocaleString('en')} of ${all.toLocaleString('en')}`,
    takenHere: (count, station) => `Show ${strings.photos.many(count)} taken at ${station}`,
    takenAt: (station) => `taken at ${station}`,
    alt: (kind, name) => `The ${kind} ${name}`,
    kinds: { spherical: 'panorama', cylindrical: 'panorama', pinhole: 'photo', visual: 'picture' },
    title: 'Photos',
    close: 'Close the photos',
    closeTip: 'Close (Esc)',
    loading: 'Loading…',
    loadingSize: (size) => `Loading ${size}…`,
    gone: 'The server no longer has photos of this point cloud.',
    unreadable: 'This photo cannot be shown',
    unreadableDetail: 'The browser cannot read the picture that came with the scan.',
    noAnswer: 'The photo could not be loaded: the server is not responding.',
    retry: 'Try again',
    previous: 'Previous photo',
    previousTip: 'Previous (←)',
    next: 'Next photo',
    nextTip: 'Next (→)',
    smaller: 'Zoom out',
    smallerTip: 'Zoom out (−)',
    larger: 'Zoom in',
    largerTip: 'Zoom in (+)',
    open: 'Open in a new tab',
    go: 'Look from here',
    goTip: 'Look at the point cloud from where this photo was taken',
  },

  stations: {
    choose: 'Go to a scan position…',
  },

  facts: {
    points: 'Points',
    extent: 'Extent',
    spacing: 'Point spacing',
    format: 'Format',
    crs: 'Coordinate system',
    attributes: 'Attributes',
    recorded: 'Recorded',
    attribution: 'Attribution',
    dropped: 'Unreadable points',
    notes: 'Notes',
    units: { metre: 'm', meter: 'm', foot: 'ft', 'us survey foot': 'ft (US)' },
  },

  /** What stands in place of the picture. */
  cover: {
    connecting: 'Connecting…',
    progress: 'Loading',
    loading: (names) => `Loading ${names}`,
    andMore: (name, count, other) => `${name} and ${count === 1 ? other : `${count} more`}`,
    empty: 'No point cloud yet',
    emptyDetail: 'The server is running, but has no scan to show. Start it with one:',
    failed: (name) => `${name} could not be loaded`,
    failedAll: 'Nothing could be loaded',
    failedUnknown: 'The server’s log says why.',
    failedAdvice: 'Once the file has been replaced and the server has read it again, the point cloud will appear here.',
    gone: (name) => `${name} is no longer here`,
    goneDetail: 'The server has removed it, or can no longer read it. If it comes back, it will appear here.',
    unknown: (id) => `There is no point cloud named “${id}”`,
    unknownDetail: 'This server does not have it. It may have been removed or renamed, or not added yet. If it becomes available, it will appear here.',
    lost: 'Connection lost',
    againIn: (seconds) => `Trying again in ${seconds} seconds.`,
    again: 'Trying again…',
    retry: 'Try again',
    retryNow: 'Try now',
    others: 'Other point clouds on this server',
  },

  token: {
    detail: 'You need an access token to see the scans on this server. Ask whoever runs it for one.',
    refused: 'That token was not accepted. Ask whoever runs this server.',
    guest: 'This link is no longer valid',
    guestDetail: 'Ask whoever sent it to you for a new one. If you have an access token, you can use that instead.',
    label: 'Access token',
    show: 'Show',
    showLabel: 'Show the token',
    hide: 'Hide',
    hideLabel: 'Hide the token',
    remember: 'Remember on this device',
    open: 'Open',
    forget: 'Forget access token',
    forgetTip: 'Removes the access token from this browser',
  },

  progress: {
    coarse: (percent) => `Coarse: still loading${percent && `, ${percent}`}`,
    waiting: 'Waiting for its turn',
    stages: { reading: 'Reading the scan', sorting: 'Sorting the points', building: 'Building the levels of detail', finishing: 'Finishing' },
    left: (time) => `${time} left`,
    fewSeconds: 'a few seconds',
    seconds: (count) => `about ${count} seconds`,
    minute: 'about a minute',
    minutes: (count) => `about ${count} minutes`,
    hour: 'about an hour',
    hours: (count) => `about ${count} hours`,
  },

  /** Why a field does not take what was typed. */
  refusals: {
    noNumber: 'Enter a number.',
    least: (value) => `Must be at least ${value}.`,
    most: (value) => `Must be at most ${value}.`,
    range: 'The minimum must be less than the maximum.',
    server: 'The server did not accept this value.',
  },

  messages: {
    refused: 'The server refused the request',
    unreadable: 'A picture could not be read',
    unreadableDetail: 'The next one will replace it.',
    close: 'Close this message',
    linkCopied: 'Link copied',
    linkCopiedDetail: 'It opens exactly this view.',
    linkInAddress: 'The link is in the address bar',
    linkInAddressDetail: 'Copy it from there: it opens exactly this view.',
    pictureSaved: 'Picture saved',
    pictureSavedDetail: (name, width, height) => `${name}, ${width} × ${height} pixels`,
    pictureFailed: 'The picture could not be saved',
    noAnswer: 'The server is not responding.',
    stops: ['Collision on', 'You cannot walk or fall through surfaces.'],
    passes: ['Collision off', 'You pass through surfaces. Press C to switch collision back on.'],
  },

  /** Where the cursor is, in the scan's own coordinates. */
  coordinates: {
    about: (place) => `≈ ${place}`,
    exact: (place, step) => `${place} · exact to ${step}`,
    of: (text, name) => `${text} · ${name}`,
  },

  /** What the methods' parameters are called; those that are not here are called what the server calls them. */
  parameters: {
    sizePx: 'Point size', scale: 'Size factor', minPx: 'Minimum size', maxPx: 'Maximum size', gain: 'Depth of the borders', footprint: 'Point shape',
    smooth: 'Smooth borders', cull: 'Hide back faces', curved: 'Curved surfaces', lowPass: 'Low-pass filter', shape: 'Outline',
    tolerance: 'Tolerance', silhouette: 'Clean silhouettes', hprScale: 'Occlusion radius', hprPx: 'Occlusion radius on screen',
    threshold: 'Occlusion threshold', noise: 'Scan noise', minGap: 'Minimum gap', spacing: 'Point spacing', normalScale: 'Normal radius',
  },
};

/** 'panel.title' → what is said there; undefined where there is nothing. Pure. */
export const stringAt = (path, words = strings) => path.split('.').reduce((at, key) => (at && Object.hasOwn(at, key) ? at[key] : undefined), /** @type {any} */ (words));

/** @type {[string, (node: any, words: string) => void][]} */
const places = [
  ['text', (node, words) => { node.textContent = words; }],
  ['label', (node, words) => node.setAttribute('aria-label', words)],
  ['tip', (node, words) => { node.title = words; }],
  ['hint', (node, words) => { node.placeholder = words; }],
];

/** Puts the strings into the elements under `root` that name them: the page's, or a tool's own. */
export function fillStrings(root, words = /** @type {any} */ (strings)) {
  for (const [place, put] of places) {
    for (const node of root.querySelectorAll(`[data-${place}]`)) put(node, stringAt(node.dataset[place], words) ?? '');
  }
}
